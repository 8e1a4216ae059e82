#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/sample_dataset.hpp"
#include "viewer/fields/potential_field.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;

constexpr double radius = 0.06, spacing = 0.02;

/// Two branches with the same constant force: what lies beyond x = 10 mm has `lost` less energy.
class Step : public test::AnalyticEnergy {
 public:
  Step(double lost, double force_jump) : lost_(lost), force_jump_(force_jump) {}
  double energy(const Vector3d& p) const override {
    return p.x() > 0.01 ? -lost_ - force_jump_ * (p.x() - 0.01) : 0;
  }
  Vector3d gradient(const Vector3d& p) const override {
    return p.x() > 0.01 ? Vector3d(-force_jump_, 0, 0) : Vector3d::Zero();
  }
  Eigen::Matrix3d hessian(const Vector3d&) const override { return Eigen::Matrix3d::Zero(); }

 private:
  double lost_, force_jump_;
};

CellData dataOf(const test::AnalyticEnergy& energy) {
  return CellData(test::solvedSpace(Lattice(radius, spacing), energy));
}

double correctionAt(const CellData& data, const LatticePoint& point) {
  return energyCorrections(data)[static_cast<std::size_t>(data.slotAt(point))];
}

TEST(EnergyCorrections, AreZeroWhereEveryEdgeIsConsistent) {
  for (const double x : energyCorrections(dataOf(test::StiffeningEnergy()))) EXPECT_EQ(x, 0);
}

TEST(EnergyCorrections, ShareAJumpOfTheEnergyOutOverThreeLeaves) {
  // In the middle of the plane of the jump the two ends are moved by the same amount d towards each
  // other: with the forces 1 - 2 d in the edge, d before and behind it, and d for the corrections
  // themselves the least sum of (1 - 2 d)^2 + 2 d^2 + 2 d^2 is at d = 1 / 4.
  constexpr double lost = 0.02;
  const CellData data = dataOf(Step(lost, 0));
  // The rim, three spacings away, changes that a little.
  EXPECT_NEAR(correctionAt(data, {0, 0, 0}), -lost / 4, 0.005 * lost);
  EXPECT_NEAR(correctionAt(data, {1, 0, 0}), lost / 4, 0.005 * lost);
}

TEST(EnergyCorrections, OnlyMoveCornersOfLeavesWithAnInconsistentEdge) {
  const CellData data = dataOf(Step(0.02, 0));
  const std::vector<double> corrections = energyCorrections(data);
  std::vector<bool> flagged(corrections.size(), false);
  for (const std::int32_t leaf : data.leavesWith(data.inconsistent))
    for (const std::int32_t slot : data.tree.corners(leaf))
      flagged[static_cast<std::size_t>(slot)] = true;
  EXPECT_TRUE(std::any_of(corrections.begin(), corrections.end(), [](double x) { return x != 0; }));
  for (std::size_t s = 0; s < corrections.size(); ++s)
    if (!flagged[s]) {
      EXPECT_EQ(corrections[s], 0);
    }
}

TEST(EnergyCorrections, LeaveAMismatchThatTheDifferenceOfTheForcesAllows) {
  // Without a loss the energies agree with the trapezoidal rule over the jump of the force.
  constexpr double jump = 4;
  const CellData within = dataOf(Step(0.09 * jump * spacing, jump)),
                 beyond = dataOf(Step(0.5 * jump * spacing, jump));
  ASSERT_FALSE(within.inconsistent.empty());
  // Away from the rim, whose ghosts continue one branch into the other.
  EXPECT_LT(std::abs(correctionAt(within, {0, 0, 0})), 0.005 * jump * spacing);
  EXPECT_LT(std::abs(correctionAt(within, {1, 0, 0})), 0.005 * jump * spacing);
  EXPECT_GT(correctionAt(beyond, {1, 0, 0}), 0.05 * jump * spacing);
}

}  // namespace
}  // namespace palpate
