#include "common/mesh/free_share.hpp"

#include <gtest/gtest.h>

#include "common/mesh/finger_weights.hpp"
#include "tests/support/meshes.hpp"

namespace palpate {
namespace {

class FreeShares : public ::testing::TestWithParam<bool> {};

TEST_P(FreeShares, AreLowerBoundsOfTheWeightsFreeShareEverywhere) {
  Mesh mesh = test::blobMesh(5);
  if (GetParam()) addMidEdgeNodes(mesh);
  const NodeSet fixed = mesh.node_groups.at("xmin");
  const FreeShare shares(mesh, fixed, 0.03);
  int between = 0;
  for (const Triangle& triangle : mesh.surface) {
    const Eigen::Vector3d middle =
        (mesh.nodes[triangle[0]] + mesh.nodes[triangle[1]] + mesh.nodes[triangle[2]]) / 3;
    const double share = fingerWeights(mesh, fixed, middle, 0.03).free_share;
    if (share > 0.01 && share < 0.99) ++between;
    for (const double difference : {1e-9, 1e-3, 0.01, 0.03, 0.3}) {
      EXPECT_TRUE(share > 1 - 1e-12 || shares.isBelow(share + difference, middle)) << share;
      EXPECT_FALSE(shares.isBelow(share - difference, middle)) << share;
    }
  }
  EXPECT_GT(between, 10);
}

INSTANTIATE_TEST_SUITE_P(OfElements, FreeShares, testing::Bool());

}  // namespace
}  // namespace palpate
