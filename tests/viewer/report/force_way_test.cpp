#include "viewer/report/force_way.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/sample_dataset.hpp"

namespace palpate {
namespace {

using ::testing::ElementsAre;

TEST(ForceWay, HasItsSolvedPointsAndTheirForces) {
  const test::StiffeningEnergy energy;
  SpaceTable space = test::solvedSpace(Lattice(0.02, 0.01), energy);
  const AxisForces both = solvedOnWay(space, Eigen::Vector3d::UnitY(), true);
  EXPECT_EQ(both.displacements.size(), 5U);
  const AxisForces diagonal = solvedOnWay(space, Eigen::Vector3d(1, 1, 0).normalized(), false);
  ASSERT_EQ(diagonal.displacements.size(), 2U);  // rest, and (1, 1, 0)
  const Eigen::Vector3d p(0.01, 0.01, 0);
  EXPECT_NEAR(diagonal.displacements[1], p.norm(), 1e-12);
  EXPECT_NEAR(diagonal.forces[1], -energy.gradient(p).dot(p.normalized()), 1e-9);
  space.points[0].tag = Tag::failed;
  EXPECT_EQ(solvedOnWay(space, Eigen::Vector3d::UnitY(), false).displacements.size(), 2U);
}

TEST(ForceWay, HasItsHeldOutSolutions) {
  const std::vector<HeldOutSolution> solutions = {
      {{0.003, 0, 0}, {-1, 5, 5}}, {{-0.003, 0, 0}, {2, 0, 0}}, {{0.003, 1e-4, 0}, {-1, 0, 0}}};
  const AxisForces ahead = heldOutOnWay(solutions, 0.02, Eigen::Vector3d::UnitX(), false);
  EXPECT_THAT(ahead.displacements, ElementsAre(0.003));
  EXPECT_THAT(ahead.forces, ElementsAre(-1));
  EXPECT_EQ(heldOutOnWay(solutions, 0.02, Eigen::Vector3d::UnitX(), true).forces.size(), 2U);
}

TEST(ForceWay, IsSampledFromOneEndToTheOther) {
  const AxisForces sampled =
      sampledOnWay([](const Eigen::Vector3d& p) -> Eigen::Vector3d { return -2 * p; },
                   Eigen::Vector3d::UnitZ(), -0.01, 0.02);
  EXPECT_DOUBLE_EQ(sampled.displacements.front(), -0.01);
  EXPECT_DOUBLE_EQ(sampled.displacements.back(), 0.02);
  EXPECT_DOUBLE_EQ(sampled.forces.back(), -0.04);
}

TEST(ForceWay, ShownOnesAreTheLargestThe95thPercentileAndTheMedian) {
  std::vector<double> values(101);
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = static_cast<double>(n);
  values.push_back(std::nan(""));
  const auto chosen = tellingOnes(values);
  ASSERT_EQ(chosen.size(), 3U);
  EXPECT_EQ(chosen[0].first, 100U);
  EXPECT_EQ(chosen[1].first, 95U);
  EXPECT_EQ(chosen[2].first, 50U);
  EXPECT_EQ(tellingOnes({3.0}).size(), 1U);
  EXPECT_TRUE(tellingOnes({std::nan("")}).empty());
}

}  // namespace
}  // namespace palpate
