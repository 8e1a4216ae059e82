#include "viewer/fields/potential_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/random_loops.hpp"
#include "tests/support/uneven_spaces.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;

constexpr double radius = 0.06, spacing = 0.02;

/// Cells of three sizes and two failed points; the boundary is unchanged.
SpaceTable unevenSpace(const test::AnalyticEnergy& energy = test::StiffeningEnergy()) {
  return test::without(test::splitSpace(Lattice(radius, spacing, 1024), test::three_sizes, energy),
                       {{-1024, 0, 0}, {1024, 512, 512}});
}

Vector3d inBall(std::mt19937& random) {
  std::uniform_real_distribution<double> coordinate(-radius, radius);
  for (;;) {
    const double x = coordinate(random), y = coordinate(random), z = coordinate(random);
    if (Vector3d(x, y, z).norm() < 0.999 * radius) return {x, y, z};
  }
}

TEST(PotentialField, AnswersInTheWholeBallWithABoundThatHolds) {
  const PotentialField field(unevenSpace());
  const test::StiffeningEnergy energy;
  std::mt19937 random(8);
  int held = 0;
  for (int n = 0; n < 1000; ++n) {
    const Vector3d p = inBall(random);
    const ForceSample sample = field.evaluate(p);
    EXPECT_TRUE(sample.inside);
    EXPECT_TRUE(std::isfinite(sample.error_bound));
    held += (sample.force + energy.gradient(p)).norm() <= sample.error_bound + 1e-12 ? 1 : 0;
  }
  EXPECT_GE(held, 990);
}

/// Soft tissue that stiffens exponentially where it is pushed along x: at a quarter of the spacing
/// the force is twice that of the stiffness at rest, at the next point 160,000 times.
class LockingEnergy : public test::AnalyticEnergy {
 public:
  double energy(const Vector3d& p) const override {
    return stiffness / 2 * (p.squaredNorm() - p.x() * p.x() + (growth(p) - 1) / rate(p));
  }
  Vector3d gradient(const Vector3d& p) const override {
    return stiffness * Vector3d(p.x() * growth(p), p.y(), p.z());
  }
  Eigen::Matrix3d hessian(const Vector3d& p) const override {
    return stiffness * Vector3d(growth(p) * (1 + 2 * rate(p) * p.x() * p.x()), 1, 1).asDiagonal();
  }

 private:
  static constexpr double stiffness = 50;
  static double rate(const Vector3d& p) { return p.x() > 0 ? 3e4 : 1e-3; }
  static double growth(const Vector3d& p) { return std::exp(rate(p) * p.x() * p.x()); }
};

TEST(PotentialField, IsUncertainTowardsFailedPointsHoweverFastTheForceGrows) {
  const LockingEnergy energy;
  SpaceTable space = test::solvedSpace(Lattice(radius, spacing), energy);
  for (std::int32_t n = 0; n < space.lattice.size(); ++n)
    if (space.lattice.displacement(n).x() > 0) space.points[at(n)] = test::failedPoint();
  const PotentialField field(space);
  std::mt19937 random(8);
  int wrong = 0, held = 0;
  for (int n = 0; n < 1000; ++n) {
    const Vector3d p = inBall(random) / 8;
    const ForceSample sample = field.evaluate(p);
    const double error = (sample.force + energy.gradient(p)).norm();
    if (!sample.inside || error < 0.03 * sample.force.norm()) continue;
    ++wrong;
    held += error <= sample.error_bound ? 1 : 0;
  }
  EXPECT_GE(wrong, 200);
  EXPECT_GE(held, 0.95 * wrong);
}

/// A fibre along x that is slack under pushes and stiffens when pulled. At rest the stiffness is
/// the mean of both sides.
class SlackEnergy : public test::AnalyticEnergy {
 public:
  double energy(const Vector3d& p) const override {
    return 25 * p.squaredNorm() + 50 * std::pow(std::max(p.x(), 0.0), 2);
  }
  Vector3d gradient(const Vector3d& p) const override {
    return 50 * p + Vector3d(100 * std::max(p.x(), 0.0), 0, 0);
  }
  Eigen::Matrix3d hessian(const Vector3d& p) const override {
    return Vector3d(50 * (p.x() > 0 ? 3 : p.x() < 0 ? 1 : 2), 50, 50).asDiagonal();
  }
};

TEST(PotentialField, IsUncertainAtRestWhereFibresBecomeTaut) {
  const SlackEnergy energy;
  SpaceTable space = test::solvedSpace(Lattice(radius, spacing), energy);
  space.has_fibers = true;
  const PotentialField field(space);
  std::mt19937 random(8);
  int held = 0;
  for (int n = 0; n < 1000; ++n) {
    const Vector3d p = inBall(random) / 6;
    const ForceSample sample = field.evaluate(p);
    held += (sample.force + energy.gradient(p)).norm() <= sample.error_bound ? 1 : 0;
  }
  EXPECT_GE(held, 950);
  EXPECT_EQ(field.evaluate(Vector3d::Zero()).error_bound, 0);
}

const test::JumpingEnergy jumping_energy(0.01, 5, 0.02);

SpaceTable jumpingSpace() { return test::solvedSpace(Lattice(radius, spacing), jumping_energy); }

TEST(PotentialField, ReturnsTheEnergyOfLoopsThroughAJump) {
  std::mt19937 random(12);
  for (const SpaceTable& space : {jumpingSpace(), unevenSpace(jumping_energy)}) {
    const PotentialField field(space);
    double exchanged = 0, net = 0;
    int through = 0;
    for (int n = 0; n < 60; ++n) {
      const test::LoopEnergy energy = loopEnergy(field, test::RandomLoop(random, 0.95 * radius));
      exchanged += energy.exchanged;
      net += std::abs(energy.net);
      through += energy.covered ? 0 : 1;
    }
    EXPECT_GT(through, 30);
    EXPECT_LE(net, 1e-9 * exchanged);
  }
}

TEST(PotentialField, HasAnEnergyInTheWholeBallWhoseDerivativeIsTheForce) {
  std::mt19937 random(14);
  constexpr double step = 1e-6;
  for (const SpaceTable& space : {jumpingSpace(), unevenSpace(jumping_energy)}) {
    const PotentialField field(space);
    for (int n = 0; n < 1000; ++n) {
      const Vector3d p = inBall(random), d = step * inBall(random).normalized();
      const ForceSample sample = field.evaluate(p);
      EXPECT_TRUE(std::isfinite(sample.energy));
      EXPECT_LE((sample.stiffness - sample.stiffness.transpose()).norm(),
                1e-9 * sample.stiffness.norm());
      const double work = field.evaluate(p - 0.5 * d).energy - field.evaluate(p + 0.5 * d).energy;
      EXPECT_NEAR(work, sample.force.dot(d), 1e-6 * step * (1 + sample.force.norm()))
          << p.transpose();
    }
  }
}

/// Across refined cells, the boundary, failed points, and cells crossed by a jump. Beside a jump
/// the stiffness itself changes by up to 2e-5 N/m over 1e-12 m.
TEST(PotentialField, HasAContinuousStiffness) {
  for (const SpaceTable& space : {unevenSpace(), jumpingSpace(), unevenSpace(jumping_energy)}) {
    std::mt19937 random(16);  // the same places in each
    const PotentialField field(space);
    for (int n = 0; n < 6000; ++n) {
      Vector3d low = inBall(random), high;
      const int axis = n % 3;
      const double grid = n % 2 == 0 ? spacing : spacing / 4;
      const double face = grid * std::round(low[axis] / grid);
      high = low;
      low[axis] = face - 1e-13;
      high[axis] = face + 1e-13;
      const ForceSample below = field.evaluate(low), above = field.evaluate(high);
      EXPECT_LE((below.force - above.force).norm(), 1e-7) << low.transpose();
      EXPECT_LE((below.stiffness - above.stiffness).norm(), 1e-5) << low.transpose();
    }
  }
}

TEST(PotentialField, KeepsStoredForcesBesideAJumpAndIsUncertainThere) {
  const SpaceTable space = jumpingSpace();
  const PotentialField field(space);
  for (std::int32_t n = 0; n < space.lattice.size(); ++n)
    EXPECT_LE(
        (field.evaluate(space.lattice.displacement(n)).force - space.points[n].equilibrium.force)
            .norm(),
        1e-8);
  std::mt19937 random(18);
  int held = 0;
  for (int n = 0; n < 1000; ++n) {
    const Vector3d p = inBall(random);
    const ForceSample sample = field.evaluate(p);
    held += (sample.force + jumping_energy.gradient(p)).norm() <= sample.error_bound ? 1 : 0;
    if (p.x() > 0.001 && p.x() < 0.019) {
      EXPECT_LT(sample.coverage, 1e-12);
      EXPECT_GE(sample.error_bound, 5);
    }
  }
  EXPECT_GE(held, 980);
}

/// Where the energy jumps between branches, a conservative force cannot equal that of both. It
/// stays within the bound given by the forces at lattice points and half of the largest energy jump
/// over an edge.
TEST(PotentialField, OvershootsByHalfTheEnergyLossOfAnEdgeAtMost) {
  constexpr double force_jump = 5;
  std::mt19937 random(20);
  for (const double lost : {0.0, 0.02, 0.1}) {
    const SpaceTable space =
        test::solvedSpace(Lattice(radius, spacing), test::JumpingEnergy(0.01, force_jump, lost));
    const PotentialField field(space);
    double largest_force = 0, largest = 0;
    for (const PointRecord& point : space.points)
      largest_force = std::max(largest_force, point.equilibrium.force.norm());
    for (int n = 0; n < 5000; ++n)
      largest = std::max(largest, field.evaluate(inBall(random)).force.norm());
    EXPECT_LE(largest, largest_force + 0.5 * (lost + force_jump * radius) / spacing);
  }
}

TEST(PotentialField, ContinuesALoneConfiguration) {
  SpaceTable space = test::solvedSpace(Lattice(radius, spacing), test::StiffeningEnergy());
  for (std::int32_t n = 1; n < space.lattice.size(); ++n) space.points[n].tag = Tag::failed;
  const PotentialField field(space);
  const Equilibrium& origin = space.points[0].equilibrium;
  const Vector3d p(0.004, -0.002, 0.001);
  const ForceSample sample = field.evaluate(p);
  EXPECT_TRUE(sample.inside);
  EXPECT_LE((sample.force - origin.force - origin.stiffness * p).norm(), 1e-9);
  EXPECT_FALSE(field.evaluate({0.03, 0.03, 0.03}).inside) << "all corners failed";
}

/// Two branches with the same constant force; beyond x = 10 mm the energy is lower by `lost`.
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

TEST(EnergyCorrections, SpreadAnEnergyJumpOverThreeLeaves) {
  // In the middle of the jump's plane the two ends move by the same amount d towards each other.
  // The forces are 1 - 2 d in the edge, d before and behind it, and d for the corrections
  // themselves, so the sum (1 - 2 d)^2 + 2 d^2 + 2 d^2 is least at d = 1 / 4.
  constexpr double lost = 0.02;
  const CellData data = dataOf(Step(lost, 0));
  // The boundary of the ball, three spacings away, changes the result a little.
  EXPECT_NEAR(correctionAt(data, {0, 0, 0}), -lost / 4, 0.005 * lost);
  EXPECT_NEAR(correctionAt(data, {1, 0, 0}), lost / 4, 0.005 * lost);
}

TEST(EnergyCorrections, ChangeOnlyCornersOfLeavesWithAnInconsistentEdge) {
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

TEST(EnergyCorrections, IgnoreAMismatchWithinTheDifferenceOfForces) {
  // Without a loss the energies agree with the trapezoidal rule across the jump of the force.
  constexpr double jump = 4;
  const CellData within = dataOf(Step(0.09 * jump * spacing, jump)),
                 beyond = dataOf(Step(0.5 * jump * spacing, jump));
  ASSERT_FALSE(within.inconsistent.empty());
  // Check points away from the boundary of the ball, where ghosts continue one branch into the
  // other.
  EXPECT_LT(std::abs(correctionAt(within, {0, 0, 0})), 0.005 * jump * spacing);
  EXPECT_LT(std::abs(correctionAt(within, {1, 0, 0})), 0.005 * jump * spacing);
  EXPECT_GT(correctionAt(beyond, {1, 0, 0}), 0.05 * jump * spacing);
}

}  // namespace
}  // namespace palpate
