#include "viewer/fields/rbf_field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/expect_error.hpp"
#include "tests/support/points_in_ball.hpp"
#include "tests/support/sample_dataset.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::AnalyticEnergy;
using test::pointsInBall;
using test::radius;
using test::solvedSpace;
using test::StiffeningEnergy;

double largestError(const ForceField& field, const AnalyticEnergy& energy, double reach) {
  double largest = 0;
  for (const Vector3d& p : pointsInBall(reach))
    largest = std::max(largest, (field.evaluate(p).force + energy.gradient(p)).norm());
  return largest;
}

/// A uniform lattice, some of whose points failed, with points of half and a quarter of the spacing
/// on one side.
SpaceTable refinedSpace(const AnalyticEnergy& energy) {
  Lattice lattice(radius, 0.005, 1024);
  for (const int step : {512, 256})
    for (int i = step; i <= 4 * step; i += step)
      for (int j = -2 * step; j <= 2 * step; j += step)
        for (int k = -2 * step; k <= 2 * step; k += step)
          if (!lattice.indexOf({i, j, k})) lattice.add({i, j, k});
  SpaceTable space = solvedSpace(lattice, energy);
  for (const std::int32_t hole : {5, 40, 41, 100}) {
    space.points[hole] = {};
    space.points[hole].tag = Tag::failed;
    space.points[hole].equilibrium.force.setConstant(1e9);  // must not be looked at
  }
  return space;
}

class EveryRbfField : public ::testing::TestWithParam<const char*> {
 protected:
  std::unique_ptr<ForceField> fieldOf(const SpaceTable& space) const {
    return makeForceField(GetParam(), space);
  }
};
INSTANTIATE_TEST_SUITE_P(ForceField, EveryRbfField, ::testing::Values("rbf-linear", "rbf-cubic"),
                         [](const auto& method) {
                           std::string name = method.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST_P(EveryRbfField, ReturnsTheStoredForcesAtSolvedPoints) {
  const SpaceTable space = refinedSpace(StiffeningEnergy());
  const auto field = fieldOf(space);
  EXPECT_EQ(field->name(), GetParam());
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    if (!isSolved(space.points[n].tag)) continue;
    const Vector3d& force = space.points[n].equilibrium.force;
    EXPECT_LE((field->evaluate(space.lattice.displacement(n)).force - force).norm(), 1e-8);
  }
}

TEST_P(EveryRbfField, StiffnessIsTheDerivativeOfItsForce) {
  const auto field = fieldOf(refinedSpace(StiffeningEnergy()));
  const double step = 1e-7;
  for (const Vector3d& p : pointsInBall(0.0199)) {
    Matrix3d differences;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d d = step * Vector3d::Unit(axis);
      differences.col(axis) =
          (field->evaluate(p + d).force - field->evaluate(p - d).force) / (2 * step);
    }
    EXPECT_LE((field->evaluate(p).stiffness - differences).norm(), 1e-5 * differences.norm());
  }
}

TEST_P(EveryRbfField, AnswersTheWholeBall) {
  const auto field = fieldOf(refinedSpace(StiffeningEnergy()));
  const StiffeningEnergy energy;
  for (const Vector3d& p : pointsInBall(radius, 1000)) {
    const ForceSample sample = field->evaluate(p);
    EXPECT_TRUE(sample.inside);
    EXPECT_LE((sample.force + energy.gradient(p)).norm(),
              0.1 * energy.gradient({radius, 0, 0}).norm());
  }
}

TEST_P(EveryRbfField, ForceIsContinuousEverywhere) {
  const auto field = fieldOf(refinedSpace(StiffeningEnergy()));
  const Vector3d direction = Vector3d(1, 2, -0.5).normalized();
  for (const Vector3d& start : pointsInBall(0.01, 5)) {
    Vector3d before = field->evaluate(start - 0.03 * direction).force;
    for (int n = 1; n <= 20000; ++n) {
      const Vector3d force = field->evaluate(start + (n * 3e-6 - 0.03) * direction).force;
      // N/m: more than the stiffness anywhere, beyond the ball of 3.3 N in 2 mm
      EXPECT_LE((force - before).norm(), 3e-6 * 2000);
      before = force;
    }
  }
}

TEST_P(EveryRbfField, IsFiniteForAnyDisplacement) {
  const auto field = fieldOf(solvedSpace(Lattice(radius, 0.005), StiffeningEnergy()));
  const double infinity = std::numeric_limits<double>::infinity(), nan = std::nan("");
  for (const Vector3d& p : {Vector3d(-1e300, 1e300, 0), Vector3d(1e308, 1e308, 1e308),
                            Vector3d(nan, 0, 0), Vector3d(0, infinity, -infinity)}) {
    const ForceSample sample = field->evaluate(p);
    EXPECT_FALSE(sample.inside);
    EXPECT_TRUE(sample.force.allFinite() && sample.stiffness.allFinite()) << p.transpose();
    EXPECT_LT(sample.force.norm(), 1000);
  }
}

TEST_P(EveryRbfField, GetsMoreAccurateWithTheSpacing) {
  const StiffeningEnergy energy;
  const double coarse =
      largestError(*fieldOf(solvedSpace(Lattice(radius, 0.005), energy)), energy, 0.01);
  const double fine =
      largestError(*fieldOf(solvedSpace(Lattice(radius, 0.0025), energy)), energy, 0.01);
  EXPECT_LT(fine, coarse / 4);
}

TEST(RbfField, RefusesASinglePoint) {
  SpaceTable space = solvedSpace(Lattice(radius, 0.01), StiffeningEnergy());
  for (std::int32_t n = 1; n < space.lattice.size(); ++n) space.points[n].tag = Tag::failed;
  test::expectError(ExitCode::failed, [&] { makeForceField("rbf-cubic", space); },
                    {"tip", "rbf-cubic", "1 solved point"});
}

}  // namespace
}  // namespace palpate
