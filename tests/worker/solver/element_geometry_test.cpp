#include "worker/solver/element_geometry.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/meshes.hpp"

namespace palpate {
namespace {

TEST(SmallestDetFAtNodes, FindsAMidEdgeNodePulledTowardsAnEndOfItsEdge) {
  Mesh mesh = test::distortedBoxMesh({0.1, 0.1, 0.05}, {2, 2, 1});
  addMidEdgeNodes(mesh);
  std::vector<double> u(3 * mesh.nodes.size(), 0.0);
  EXPECT_NEAR(smallestDetFAtNodes(mesh, u).det_F, 1, 1e-12);
  // After a move by h, the slope along the edge is 1 - 4 h / length at the end that the mid-edge
  // node approaches.
  const std::int32_t element = 5, a = mesh.tetrahedra[element][0], b = mesh.tetrahedra[element][1];
  const std::int32_t middle = mesh.mid_edge_nodes[element][0];
  for (int i = 0; i < 3; ++i) u[3 * middle + i] = 0.2 * (mesh.nodes[b] - mesh.nodes[a])[i];
  const SmallestDetF smallest = smallestDetFAtNodes(mesh, u);
  EXPECT_NEAR(smallest.det_F, 0.2, 1e-12);
  const Tetrahedron& worst = mesh.tetrahedra[smallest.element];
  EXPECT_EQ(std::count(worst.begin(), worst.end(), b), 1);
}

TEST(SmallestDetFAtNodes, IsEmptyForALinearMesh) {
  const Mesh mesh = test::distortedBoxMesh({0.1, 0.1, 0.05}, {2, 2, 1});
  EXPECT_EQ(smallestDetFAtNodes(mesh, std::vector<double>(3 * mesh.nodes.size(), 0.0)).element, -1);
}

}  // namespace
}  // namespace palpate
