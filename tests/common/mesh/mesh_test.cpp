#include "common/mesh/mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/meshes.hpp"

namespace palpate {
namespace {

using test::expectBadInput;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Mesh unfinishedTetrahedron() {
  Mesh mesh = test::tetrahedronMesh();
  mesh.surface.clear();
  return mesh;
}

Eigen::Vector3d areaVector(const Mesh& mesh, const Triangle& t) {
  return (mesh.nodes[t[1]] - mesh.nodes[t[0]]).cross(mesh.nodes[t[2]] - mesh.nodes[t[0]]) / 2;
}

TEST(Mesh, CubeHasTheVolumeSurfaceAndCountsOfACube) {
  const Mesh mesh = test::cubeMesh(0.3, 3);
  EXPECT_EQ(mesh.nodes.size(), 64u);
  EXPECT_EQ(mesh.tetrahedra.size(), 162u);
  EXPECT_EQ(mesh.surface.size(), 6u * 9 * 2);
  EXPECT_EQ(surfaceNodes(mesh).size(), 64u - 8);
  EXPECT_NEAR(measure(mesh).volume, 0.027, 1e-15);
  EXPECT_EQ(mesh.node_groups.at("xmin").size(), 16u);
}

TEST(Mesh, SurfaceIsClosedAndItsNormalsPointOutward) {
  const Mesh mesh = test::blobMesh();
  Eigen::Vector3d total_area = Eigen::Vector3d::Zero();
  double volume = 0;  // by the divergence theorem
  for (const Triangle& t : mesh.surface) {
    total_area += areaVector(mesh, t);
    volume += areaVector(mesh, t).dot(mesh.nodes[t[0]]) / 3;
  }
  EXPECT_LT(total_area.norm(), 1e-15);
  EXPECT_NEAR(volume, measure(mesh).volume, 1e-12);
}

TEST(Mesh, EverySharedBodyIsPositiveAndWellShaped) {
  const Mesh bodies[] = {test::cubeMesh(1, 2), test::distortedBoxMesh({1, 2, 3}, {4, 4, 4}),
                         test::beamMesh(), test::blobMesh(), test::tetrahedronMesh()};
  for (const Mesh& mesh : bodies) {
    EXPECT_GT(measure(mesh).worst_shape, 0.1);
    EXPECT_EQ(measure(mesh).pieces, 1);
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) EXPECT_GT(sixVolume(mesh, e), 0);
  }
}

TEST(Mesh, DistortedBoxMovesInnerNodesOnly) {
  const Mesh straight = test::boxMesh({1, 1, 1}, {3, 3, 3}),
             distorted = test::distortedBoxMesh({1, 1, 1}, {3, 3, 3});
  int moved = 0;
  for (std::size_t n = 0; n < straight.nodes.size(); ++n)
    moved += straight.nodes[n] != distorted.nodes[n];
  EXPECT_EQ(moved, 8);
  EXPECT_NEAR(measure(distorted).volume, 1, 1e-14);
}

TEST(Mesh, RegularTetrahedronHasShapeOne) {
  Mesh mesh;
  mesh.nodes = {{1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}};
  mesh.tetrahedra = {{0, 1, 2, 3}};
  finishMesh(mesh, "regular");
  EXPECT_NEAR(shapeOf(mesh, 0), 1, 1e-14);
  EXPECT_NEAR(measure(mesh).mean_edge, std::sqrt(8), 1e-14);
}

TEST(Mesh, DropsUnusedNodesAlsoFromGroups) {
  Mesh mesh = unfinishedTetrahedron();
  mesh.nodes.insert(mesh.nodes.begin(), Eigen::Vector3d(9, 9, 9));
  for (std::int32_t& node : mesh.tetrahedra[0]) ++node;
  mesh.node_groups = {{"some", {4, 0, 2, 2}}, {"gone", {0}}};
  finishMesh(mesh, "orphan");
  EXPECT_EQ(mesh.dropped_nodes, 1);
  EXPECT_EQ(mesh.nodes.size(), 4u);
  EXPECT_THAT(mesh.tetrahedra[0], ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(mesh.node_groups["some"], ElementsAre(1, 3));
  EXPECT_TRUE(mesh.node_groups["gone"].empty());
}

TEST(Mesh, ReversesElementsOfNegativeVolume) {
  for (const std::size_t every : {1u, 5u}) {
    Mesh mesh = test::cubeMesh(1, 2);
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); e += every)
      std::swap(mesh.tetrahedra[e][0], mesh.tetrahedra[e][1]);
    finishMesh(mesh, "mirrored");
    EXPECT_EQ(mesh.reoriented_tetrahedra, every == 1 ? 48 : 10);
    EXPECT_NEAR(measure(mesh).volume, 1, 1e-12);
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) EXPECT_GT(sixVolume(mesh, e), 0);
  }
}

TEST(Mesh, RefusesElementsThatFoldOverTheirNeighbours) {
  Mesh mesh = test::cubeMesh(1, 2);
  mesh.nodes[13] = {1.6, 0.5, 0.5};  // moves the middle node out through a side
  expectBadInput([&] { finishMesh(mesh, "folded.msh"); },
                 {"folded.msh", "same side", "folds over itself"});
}

TEST(Mesh, RefusesADegenerateElementNamingIt) {
  Mesh mesh = test::cubeMesh(1, 1);
  mesh.nodes.emplace_back(0.5, 0.5, 0);
  mesh.tetrahedra.push_back({0, 1, 3, 8});
  expectBadInput([&] { finishMesh(mesh, "flat.msh"); },
                 {"flat.msh", "tetrahedron 6", "degenerate"});
}

TEST(Mesh, RefusesARepeatedNode) {
  Mesh mesh = unfinishedTetrahedron();
  mesh.tetrahedra[0][3] = 0;
  expectBadInput([&] { finishMesh(mesh, "m"); }, {"tetrahedron 0", "twice"});
}

TEST(Mesh, RefusesIndicesOutOfRange) {
  for (const std::int32_t wrong : {-1, 4, 1000000}) {
    Mesh mesh = unfinishedTetrahedron();
    mesh.tetrahedra[0][2] = wrong;
    expectBadInput([&] { finishMesh(mesh, "m"); }, {"tetrahedron 0", "does not exist"});
  }
  Mesh mesh = unfinishedTetrahedron();
  mesh.node_groups["g"] = {17};
  expectBadInput([&] { finishMesh(mesh, "m"); }, {"group \"g\"", "17"});
}

TEST(Mesh, RefusesCoordinatesThatAreNotFinite) {
  Mesh mesh = unfinishedTetrahedron();
  mesh.nodes[2][1] = std::numeric_limits<double>::quiet_NaN();
  expectBadInput([&] { finishMesh(mesh, "m"); }, {"node 2", "not finite"});
  mesh.nodes[2][1] = -2e12;
  expectBadInput([&] { finishMesh(mesh, "m"); }, {"node 2", "beyond 1e+12", "unit"});
}

TEST(Mesh, RefusesAMeshWithoutTetrahedra) {
  Mesh mesh;
  mesh.nodes = {{0, 0, 0}};
  expectBadInput([&] { finishMesh(mesh, "m"); }, {"no tetrahedra"});
}

TEST(Mesh, RefusesAFaceSharedByThreeTetrahedra) {
  Mesh mesh = unfinishedTetrahedron();
  mesh.nodes.emplace_back(0.2, 0.2, -1);
  mesh.nodes.emplace_back(0.3, 0.2, -1);
  mesh.tetrahedra.push_back({0, 2, 1, 4});
  mesh.tetrahedra.push_back({0, 2, 1, 5});
  expectBadInput([&] { finishMesh(mesh, "m"); }, {"3 tetrahedra share one face"});
}

TEST(Mesh, NumbersComponentsByTheirFirstNodes) {
  Mesh mesh = unfinishedTetrahedron();
  for (int n = 0; n < 4; ++n) mesh.nodes.push_back(mesh.nodes[n] + Eigen::Vector3d(5, 0, 0));
  mesh.tetrahedra.push_back({4, 5, 6, 7});
  finishMesh(mesh, "two");
  EXPECT_THAT(piecesOf(mesh), ElementsAre(NodeSet{0, 1, 2, 3}, NodeSet{4, 5, 6, 7}));
  EXPECT_EQ(measure(mesh).pieces, 2);
}

TEST(Mesh, ComponentsAreConnectedByFacesNotByNodesOrEdges) {
  const auto measured = [](const Eigen::Vector3d& by) {
    Mesh mesh =
        test::welded(test::together(test::cubeMesh(1, 1), test::moved(test::cubeMesh(1, 1), by)));
    addMidEdgeNodes(mesh);
    return measure(mesh);
  };
  EXPECT_EQ(measured({1, 0, 0}).pieces, 1) << "a face";
  EXPECT_THAT(measured({1, 0, 0}).hinges, IsEmpty());
  EXPECT_EQ(measured({1, 1, 0}).pieces, 2) << "an edge";
  EXPECT_THAT(measured({1, 1, 0}).hinges, SizeIs(3));
  EXPECT_EQ(measured({1, 1, 1}).pieces, 2) << "a node";
  EXPECT_THAT(measured({1, 1, 1}).hinges, ElementsAre(7));
}

TEST(Mesh, CountsCoincidentVertices) {
  const auto coincident = [](const Eigen::Vector3d& by) {
    return measure(test::together(test::cubeMesh(1, 3), test::moved(test::cubeMesh(1, 3), by)))
        .coincident;
  };
  EXPECT_THAT(coincident({1, 0, 0}), SizeIs(16));
  EXPECT_THAT(coincident({1, 0, 0}), Contains(Edge{64, 3}));
  EXPECT_THAT(coincident({1 + 1e-7, 0, 0}), SizeIs(16));
  EXPECT_THAT(coincident({1 + 1e-5, 0, 0}), IsEmpty());
  EXPECT_THAT(coincident({2, 0, 0}), IsEmpty());
}

TEST(Mesh, QuadraticMeshHasOneNodeInTheMiddleOfEveryEdge) {
  const Mesh linear = test::distortedBoxMesh({1, 2, 3}, {2, 2, 2});
  Mesh mesh = linear;
  addMidEdgeNodes(mesh);
  EXPECT_EQ(mesh.vertices(), 27);
  // The Euler characteristic of a ball is 1: vertices - edges + faces - tetrahedra.
  const auto faces = (4 * mesh.tetrahedra.size() + mesh.surface.size()) / 2;
  EXPECT_EQ(27 + faces - mesh.tetrahedra.size() - mesh.edges.size(), 1u);
  EXPECT_EQ(mesh.nodes.size(), 27 + mesh.edges.size());
  EXPECT_TRUE(std::is_sorted(mesh.edges.begin(), mesh.edges.end()));
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e)
    for (std::size_t i = 0; i < 6; ++i) {
      const std::int32_t a = mesh.tetrahedra[e][tetrahedron_edges[i][0]],
                         b = mesh.tetrahedra[e][tetrahedron_edges[i][1]];
      EXPECT_EQ(mesh.mid_edge_nodes[e][i], midEdgeNode(mesh, a, b));
      EXPECT_EQ(mesh.nodes[midEdgeNode(mesh, b, a)], 0.5 * (mesh.nodes[a] + mesh.nodes[b]));
    }
  EXPECT_EQ(midEdgeNode(mesh, 0, 2), -1);
  EXPECT_EQ(surfaceNodes(mesh), surfaceNodes(linear));
  EXPECT_NEAR(measure(mesh).volume, measure(linear).volume, 1e-14);
}

TEST(Mesh, AGroupIncludesMidEdgeNodesBetweenItsNodes) {
  Mesh mesh = test::cubeMesh(1, 2);
  addMidEdgeNodes(mesh);
  const std::vector<std::int32_t>& side = mesh.node_groups.at("xmin");
  EXPECT_EQ(side.size(), 25u);  // a 5 x 5 lattice: 9 vertices, 12 edges along axes, 4 diagonals
  EXPECT_TRUE(std::is_sorted(side.begin(), side.end()));
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    EXPECT_EQ(std::binary_search(side.begin(), side.end(), static_cast<std::int32_t>(n)),
              mesh.nodes[n][0] == 0);
}

TEST(Mesh, MidEdgeNodesBelongToTheComponentOfTheirEdge) {
  Mesh mesh = unfinishedTetrahedron();
  for (int n = 0; n < 4; ++n) mesh.nodes.push_back(mesh.nodes[n] + Eigen::Vector3d(5, 0, 0));
  mesh.tetrahedra.push_back({4, 5, 6, 7});
  finishMesh(mesh, "two");
  addMidEdgeNodes(mesh);
  const std::vector<NodeSet> pieces = piecesOf(mesh);
  ASSERT_EQ(pieces.size(), 2u);
  for (std::size_t p = 0; p < 2; ++p) {
    EXPECT_EQ(pieces[p].size(), 10u);
    for (const std::int32_t n : pieces[p]) EXPECT_EQ(mesh.nodes[n][0] > 4, p == 1);
  }
}

TEST(Mesh, RefusesGroupsOfMissingTetrahedra) {
  Mesh mesh = unfinishedTetrahedron();
  mesh.element_groups["vessel"] = {1};
  expectBadInput([&] { finishMesh(mesh, "m"); }, {"group \"vessel\"", "tetrahedron", "1 of 1"});
}

TEST(Mesh, FindsCurvedEdges) {
  Mesh mesh = test::tetrahedronMesh();
  addMidEdgeNodes(mesh);
  std::array<std::int32_t, 10> nodes = {0, 1, 2, 3};
  std::copy(mesh.mid_edge_nodes[0].begin(), mesh.mid_edge_nodes[0].end(), nodes.begin() + 4);
  EXPECT_EQ(curvedEdge(mesh.nodes, nodes), "");
  mesh.nodes[nodes[9]][1] += 1e-5;
  EXPECT_THAT(curvedEdge(mesh.nodes, nodes), ::testing::HasSubstr("(0, 0.5, 0.5)"));
}

}  // namespace
}  // namespace palpate
