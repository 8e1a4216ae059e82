#include "common/problem/pressure_slots.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/meshes.hpp"

namespace palpate {
namespace {

/// A cube of 2 x 2 x 2 cells. regionAt gives the region of an element from its centroid.
class PressureSlotsTest : public ::testing::Test {
 protected:
  PressureSlots slots(const std::vector<Material>& materials, auto regionAt,
                      PressureSpace space = PressureSpace::p1) {
    region_of.clear();
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e)
      region_of.push_back(static_cast<std::uint16_t>(regionAt(middleOf(mesh, e))));
    return {space, mesh, materials, region_of};
  }
  static int upper(const Eigen::Vector3d& X) { return X[2] > 0.5 ? 1 : 0; }

  const Material soft = {.law = LawName::neo_hookean, .mu = 3000},
                 stiff = {.law = LawName::neo_hookean, .mu = 30000},
                 bone = {.law = LawName::linear, .young = 1e8, .poisson = 0.3};
  Mesh mesh = test::cubeMesh(1, 2);
  std::vector<std::uint16_t> region_of;
};

TEST_F(PressureSlotsTest, OneMaterialHasOnePerNode) {
  EXPECT_EQ(slots({soft}, [](const auto&) { return 0; }).count(), 27u);
  EXPECT_EQ(slots({soft, soft}, upper).count(), 27u) << "two regions of it are one material";
  EXPECT_EQ(slots(
                {soft}, [](const auto&) { return 0; }, PressureSpace::none)
                .count(),
            0u);
}

TEST_F(PressureSlotsTest, TwoMaterialsHaveTwoAtSharedNodes) {
  const PressureSlots between = slots({soft, stiff}, upper);
  EXPECT_EQ(between.count(), 27u + 9u);
  EXPECT_EQ(between.nodes(), 27u);
  std::set<std::int32_t> seen;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e)
    for (const std::int32_t node : mesh.tetrahedra[e]) {
      const std::int32_t slot = between.slotOf(node, region_of[e]);
      EXPECT_EQ(slot == node, region_of[e] == 0 || mesh.nodes[node][2] > 0.5);
      seen.insert(slot);
    }
  EXPECT_EQ(seen.size(), between.count());
  addMidEdgeNodes(mesh);
  EXPECT_EQ(slots({soft, stiff}, upper, PressureSpace::p2).count(), 125u + 25u);
}

TEST_F(PressureSlotsTest, ThreeMaterialsHaveThreeAtTheirSharedEdge) {
  const PressureSlots three =
      slots({soft, stiff, {.law = LawName::neo_hookean, .mu = 500}},
            [](const Eigen::Vector3d& X) { return X[2] > 0.5 ? (X[0] > 0.5 ? 1 : 2) : 0; });
  EXPECT_EQ(three.furtherAt(13).size(), 2u) << "the middle of the cube";
  EXPECT_EQ(three.furtherAt(0).size(), 0u);
  // All 27 nodes have a slot. The 9 nodes on top of the soft half have a second one, and 3 of
  // these, on the edge between the two other materials, a third. The 3 nodes above this edge have a
  // second slot.
  EXPECT_EQ(three.count(), 27u + 9u + 3u + 3u);
}

TEST_F(PressureSlotsTest, AMaterialWithoutPressureHasNone) {
  EXPECT_EQ(slots({soft, bone}, upper).count(), 27u);
}

}  // namespace
}  // namespace palpate
