#include "viewer/fields/point_blend.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support/uneven_spaces.hpp"
#include "viewer/fields/pressure_field.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using test::holedSpace;
using test::pointsInBall;
using test::refinedSpace;

/// The blend of the constant 1 and of the place itself must reproduce both linear functions.
TEST(PointBlend, ContinuesLinearFunctionsFromSolvedPointsToAllSlots) {
  SpaceTable space = refinedSpace(0.01);
  space.points[at(*space.lattice.indexOf({-1024, 0, 0}))] = {};
  const PointBlend blend(space);
  std::array<int, 3> kinds = {0, 0, 0};
  for (std::int32_t s = 0; s < std::ssize(blend.tree().slots()); ++s) {
    ++kinds[static_cast<std::size_t>(blend.tree().slots()[at(s)].kind)];
    double sum = 0;
    Vector3d place = Vector3d::Zero();
    for (const PointShare& share : blend.ofSlot(s)) {
      const std::int32_t point = blend.points()[at(share.row)];
      EXPECT_TRUE(isSolved(space.points[at(point)].tag));
      sum += share.factor;
      place += share.factor * space.lattice.displacement(point);
    }
    EXPECT_NEAR(sum, 1, 1e-8) << s;
    EXPECT_LT((place - blend.tree().displacement(s)).norm(), 1e-9) << s;
  }
  for (const int count : kinds) EXPECT_GT(count, 0) << "of solved, ghosts and hanging ones";
}

TEST(PointBlend, DoesNotContinueAcrossAJump) {
  const SpaceTable space = test::branchedSpace();
  const std::vector<LatticeEdge> jumps = inconsistentEdges(space);
  ASSERT_FALSE(jumps.empty());
  const PointBlend blend(space);
  const auto pointOf = [&](const PointShare& share) { return blend.points()[at(share.row)]; };
  for (std::int32_t s = 0; s < std::ssize(blend.tree().slots()); ++s) {
    const CellSlot& slot = blend.tree().slots()[at(s)];
    if (slot.kind != SlotKind::ghost) continue;
    const auto awayFrom = [&](const PointShare& share) {
      LatticePoint step = space.lattice.point(pointOf(share));
      for (std::size_t axis = 0; axis < 3; ++axis) step[axis] -= slot.point[axis];
      return squaredNorm(step);
    };
    const std::int32_t nearest = pointOf(*std::ranges::min_element(blend.ofSlot(s), {}, awayFrom));
    for (const PointShare& share : blend.ofSlot(s)) {
      const std::int32_t other = pointOf(share);
      const LatticeEdge edge{std::min(nearest, other), std::max(nearest, other)};
      EXPECT_EQ(std::ranges::count(jumps, edge), 0);
    }
  }
}

TEST(PointBlend, IsTheConfigurationItselfAtEverySolvedPoint) {
  const SpaceTable space = holedSpace();
  const PointBlend blend(space);
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    if (!isSolved(space.points[at(n)].tag)) continue;
    const auto shares = blend.sharesAt(space.lattice.displacement(n));
    ASSERT_EQ(shares.size(), 1U) << n;
    EXPECT_EQ(blend.points()[at(shares[0].row)], n);
    EXPECT_EQ(shares[0].factor, 1.0);
  }
}

/// Blending numbers of points gives the same as the pressure field: in holes, on finer leaves, at
/// the boundary and beyond it.
TEST(PointBlend, InterpolatesAsThePressureField) {
  for (const SpaceTable& space : {holedSpace(), refinedSpace(0.005)}) {
    std::vector<float> values;
    for (std::int32_t n = 0; n < space.lattice.size(); ++n)
      values.push_back(isSolved(space.points[at(n)].tag) ? static_cast<float>(std::sin(7.0 * n))
                                                         : std::numeric_limits<float>::quiet_NaN());
    const PressureField seen(space, values);
    const PointBlend blend(space);
    std::vector<Vector3d> places = pointsInBall(test::radius);
    places.emplace_back(1, -2, 0.5);
    places.push_back(Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
    for (const Vector3d& p : places) {
      double sum = 0, whole = 0;
      std::int32_t last = -1;
      for (const PointShare& share : blend.sharesAt(p)) {
        EXPECT_GT(share.row, last) << "in ascending order, each once";
        last = share.row;
        sum += share.factor * values[at(blend.points()[at(share.row)])];
        whole += share.factor;
      }
      std::array<float, 1> expected = {0};
      seen.add(p, 1, expected);
      EXPECT_NEAR(sum, expected[0], 2e-6);
      EXPECT_NEAR(whole, 1, 1e-12);
    }
  }
}

}  // namespace
}  // namespace palpate
