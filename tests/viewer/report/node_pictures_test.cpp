#include "viewer/report/node_pictures.hpp"

#include <gtest/gtest.h>

#include "tests/support/sample_dataset.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

SliceMap sampled(double radius, const std::vector<HeldOutSolution>& held_out = {}) {
  const SpaceTable space = test::solvedSpace(Lattice(radius, radius / 2), test::StiffeningEnergy());
  return sampleSlice(*makeForceField("potential", space), space, 0, 2, held_out);
}

TEST(SliceMap, ShowsLatticePointsOfThePlaneAndErrorsCloseToIt) {
  HeldOutSolution close, far;
  close.displacement = {0.003, 0.0005, -0.004};
  far.displacement = {0.003, 0.002, -0.004};
  const SliceMap map = sampled(0.02, {close, far});
  EXPECT_EQ(map.marks.size(), 13U);  // of 33
  ASSERT_EQ(map.errors.size(), 1U);
  EXPECT_EQ(map.errors[0].at, Eigen::Vector2d(0.003, -0.004));
  EXPECT_GT(map.errors[0].error, 0);
}

TEST(SliceMap, HasBoundsAndCoverageInTheBall) {
  const SliceMap map = sampled(0.02);
  const int middle = SliceMap::side / 2;
  const auto sampleAt = [](int row, int column) {
    return static_cast<std::size_t>(row * SliceMap::side + column);
  };
  EXPECT_TRUE(std::isnan(map.bound[sampleAt(0, 0)]));
  EXPECT_TRUE(std::isfinite(map.bound[sampleAt(middle, middle)]));
  EXPECT_TRUE(map.covered[sampleAt(middle, middle)]);
  EXPECT_FALSE(map.covered[sampleAt(0, middle)]);
}

}  // namespace
}  // namespace palpate
