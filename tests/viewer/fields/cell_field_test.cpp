#include "viewer/fields/cell_field.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/uneven_spaces.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using test::AnalyticEnergy;
using test::pointsInBall;
using test::PolynomialEnergy;
using test::radius;
using test::solvedSpace;
using test::StiffeningEnergy;

constexpr double spacing = 0.005;

/// Methods without an energy, which blend forces where branches meet.
class EveryBlendedField : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(CellField, EveryBlendedField, ::testing::Values("trilinear", "tricubic"),
                         [](const auto& method) { return method.param; });

SpaceTable smooth() { return solvedSpace(Lattice(radius, spacing), StiffeningEnergy()); }

SpaceTable refined(const AnalyticEnergy& energy) {
  return test::splitSpace(Lattice(radius, spacing, 1024), test::three_sizes, energy);
}

TEST_P(EveryBlendedField, IsTriLinearWhereBranchesMeetAndSmoothElsewhere) {
  const SpaceTable space = test::branchedSpace(), whole = smooth();
  const auto field = makeForceField(GetParam(), space), linear = makeForceField("trilinear", space),
             unbroken = makeForceField(GetParam(), whole);
  const Vector3d across(0.0068, 0.0021, -0.0013), touching(0.004, 0.0021, -0.0013),
      away(-0.002, 0.0021, 0);
  const ForceSample sample = field->evaluate(across);
  EXPECT_LE((sample.force - linear->evaluate(across).force).norm(), 1e-12);
  EXPECT_LE((sample.stiffness - linear->evaluate(across).stiffness).norm(), 1e-8);
  EXPECT_TRUE(std::isnan(sample.energy));
  EXPECT_EQ(sample.coverage, 0);
  EXPECT_TRUE(sample.inside);
  if (GetParam() == "trilinear")
    EXPECT_GE(sample.error_bound, 5);
  else
    EXPECT_TRUE(std::isnan(sample.error_bound)) << "tri-linear never has one";
  EXPECT_LT(field->evaluate(touching).coverage, 1);
  EXPECT_LE((field->evaluate(away).force - unbroken->evaluate(away).force).norm(), 1e-3);
  EXPECT_EQ(field->evaluate(Vector3d(-0.007, 0.0021, 0)).force,
            unbroken->evaluate(Vector3d(-0.007, 0.0021, 0)).force);
}

TEST_P(EveryBlendedField, NeverErrsMoreThanTriLinearNextToAJump) {
  const auto field = makeForceField(GetParam(), test::branchedSpace()),
             linear = makeForceField("trilinear", test::branchedSpace());
  double worst = 0, worst_linear = 0;
  for (const Vector3d& p : pointsInBall(radius, 4000)) {
    const Vector3d exact = -test::JumpingEnergy(0.007).gradient(p);
    worst = std::max(worst, (field->evaluate(p).force - exact).norm());
    worst_linear = std::max(worst_linear, (linear->evaluate(p).force - exact).norm());
  }
  EXPECT_GT(worst_linear, 2);
  EXPECT_LE(worst, worst_linear + 1e-12);
}

TEST(TricubicField, CountsThePointsOfItsDifferencesAsCorners) {
  const Vector3d beside_the_hole(-0.0025, 0.0025, 0.0025);
  EXPECT_DOUBLE_EQ(makeForceField("tricubic", smooth())->evaluate(beside_the_hole).coverage, 1);
  EXPECT_LT(makeForceField("tricubic", test::holedSpace())->evaluate(beside_the_hole).coverage, 1);
}

double meanError(std::string_view method, double h, double reach) {
  const auto field = makeForceField(method, solvedSpace(Lattice(radius, h), StiffeningEnergy()));
  double sum = 0;
  for (const Vector3d& p : pointsInBall(reach, 1000))
    sum += (field->evaluate(p).force + StiffeningEnergy().gradient(p)).norm();
  return sum;
}

TEST(TricubicField, ConvergesWithTheThirdPowerOfTheSpacing) {
  EXPECT_GT(std::log2(meanError("tricubic", 0.004, 0.008) / meanError("tricubic", 0.002, 0.008)),
            2.8);
}

TEST(TricubicField, ReproducesCubicEnergiesWhereverTheLatticeIsComplete) {
  const PolynomialEnergy cubic(3, radius);
  for (const SpaceTable& space : {solvedSpace(Lattice(radius, spacing), cubic), refined(cubic)}) {
    const auto field = makeForceField("tricubic", space);
    for (const Vector3d& p : pointsInBall(0.008, 300)) {
      const ForceSample sample = field->evaluate(p);
      EXPECT_LE((sample.force + cubic.gradient(p)).norm(), 1e-6 * cubic.gradient(p).norm());
      EXPECT_LE((sample.stiffness + cubic.hessian(p)).norm(), 1e-6 * cubic.hessian(p).norm());
    }
  }
}

TEST(TrilinearField, ErrorBoundHoldsForSmoothForces) {
  const auto field = makeForceField("trilinear", refined(StiffeningEnergy()));
  int held = 0;
  double bound = 0, error = 0;
  for (const Vector3d& p : pointsInBall(radius, 1000)) {
    const ForceSample sample = field->evaluate(p);
    const double e = (sample.force + StiffeningEnergy().gradient(p)).norm();
    held += e <= sample.error_bound ? 1 : 0;
    bound += sample.error_bound;
    error += e;
  }
  EXPECT_GE(held, 990);
  EXPECT_LT(bound, 10 * error);
}

}  // namespace
}  // namespace palpate
