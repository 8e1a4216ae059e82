#include "viewer/fields/cell_field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/support/points_in_ball.hpp"
#include "tests/support/sample_dataset.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::AnalyticEnergy;
using test::pointsInBall;
using test::PolynomialEnergy;
using test::radius;
using test::solvedSpace;
using test::StiffeningEnergy;

constexpr double spacing = 0.005;

/// The methods that are made of nodal data.
class EveryCellField : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(CellField, EveryCellField,
                         ::testing::Values("trilinear", "tricubic", "potential"),
                         [](const auto& method) { return method.param; });

/// Those without an energy, whose forces are blended where branches meet.
class EveryBlendedField : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(CellField, EveryBlendedField, ::testing::Values("trilinear", "tricubic"),
                         [](const auto& method) { return method.param; });

SpaceTable smooth() { return solvedSpace(Lattice(radius, spacing), StiffeningEnergy()); }

SpaceTable withHoles() {
  SpaceTable space = smooth();
  for (const LatticePoint& hole : {LatticePoint{1, 0, 0}, LatticePoint{1, 1, 0},
                                   LatticePoint{0, -2, 1}, LatticePoint{0, -2, 2}})
    space.points[*space.lattice.indexOf(hole)] = {};
  space.points[*space.lattice.indexOf({-1, -1, -1})].tag = Tag::failed;
  return space;
}

void addCorners(Lattice& lattice, const LatticePoint& lowest, std::int32_t step) {
  for (std::int32_t i = 0; i <= 2; ++i)
    for (std::int32_t j = 0; j <= 2; ++j)
      for (std::int32_t k = 0; k <= 2; ++k)
        if (const LatticePoint p{lowest[0] + step * i, lowest[1] + step * j, lowest[2] + step * k};
            !lattice.indexOf(p))
          lattice.add(p);
}

/// Two neighbouring cells split, and an eighth of one of them once more.
SpaceTable refined(const AnalyticEnergy& energy) {
  Lattice lattice(radius, spacing, 1024);
  addCorners(lattice, {0, 0, 0}, 512);
  addCorners(lattice, {-1024, 0, 0}, 512);
  addCorners(lattice, {512, 0, 0}, 256);
  SpaceTable space = solvedSpace(lattice, energy);
  space.splits = {{{-1024, 0, 0}, 0}, {{0, 0, 0}, 0}, {{512, 0, 0}, 1}};
  return space;
}

/// Two branches, each with its own energy, that meet at x = 7 mm: between lattice planes.
class JumpingEnergy : public AnalyticEnergy {
 public:
  double energy(const Vector3d& p) const override {
    return smooth_.energy(p) - (jumped(p) ? 5 * p.y() : 0);
  }
  Vector3d gradient(const Vector3d& p) const override {
    return smooth_.gradient(p) - (jumped(p) ? Vector3d(0, 5, 0) : Vector3d::Zero());
  }
  Matrix3d hessian(const Vector3d& p) const override { return smooth_.hessian(p); }

 private:
  static bool jumped(const Vector3d& p) { return p.x() > 0.007; }
  StiffeningEnergy smooth_;
};

SpaceTable branches() { return solvedSpace(Lattice(radius, spacing), JumpingEnergy()); }

TEST_P(EveryCellField, ForceIsContinuousOverHolesLevelsBranchesAndTheSphere) {
  for (const SpaceTable& space : {withHoles(), refined(StiffeningEnergy()), branches()}) {
    const auto field = makeForceField(GetParam(), space);
    const auto jump = [&](const Vector3d& p,
                          const Vector3d& step) {  // beyond what the stiffness says
      const ForceSample low = field->evaluate(p - step), high = field->evaluate(p + step);
      // What lies beyond the edge is looked at in answered_region_test.cpp.
      if (low.beyond > 1e-11 || high.beyond > 1e-11) return 0.0;
      return (high.force - low.force).norm() - 2 * low.stiffness.norm() * step.norm();
    };
    for (const Vector3d& p : pointsInBall(radius, 2000)) {
      for (int axis = 0; axis < 3; ++axis) {
        Vector3d on_face = p;
        on_face[axis] = spacing / 4 * std::round(4 * p[axis] / spacing);
        EXPECT_LE(jump(on_face, 1e-12 * Vector3d::Unit(axis)), 1e-8) << on_face.transpose();
      }
      EXPECT_LE(jump(radius * p.normalized(), 1e-12 * p.normalized()), 1e-8) << "at the sphere";
    }
  }
}

TEST_P(EveryCellField, StiffnessIsTheDerivativeOfItsForceInTheRegion) {
  const double step = 1e-8;
  for (const SpaceTable& space : {withHoles(), refined(StiffeningEnergy()), branches()}) {
    const auto field = makeForceField(GetParam(), space);
    for (const Vector3d& p : pointsInBall(radius, 300)) {
      if (field->evaluate(p).beyond > 0) continue;
      Matrix3d differences;
      for (int axis = 0; axis < 3; ++axis) {
        const Vector3d d = step * Vector3d::Unit(axis);
        differences.col(axis) =
            (field->evaluate(p + d).force - field->evaluate(p - d).force) / (2 * step);
      }
      EXPECT_LE((field->evaluate(p).stiffness - differences).norm(),
                1e-4 * differences.norm() + 1e-4)
          << p.transpose();
    }
  }
}

TEST_P(EveryCellField, ReturnsTheStoredForcesAtSolvedPointsOfTheBall) {
  for (const SpaceTable& space : {withHoles(), branches()}) {
    const auto field = makeForceField(GetParam(), space);
    for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
      const ForceSample sample = field->evaluate(space.lattice.displacement(n));
      if (!isSolved(space.points[n].tag) || sample.beyond > 0) continue;
      EXPECT_LE((sample.force - space.points[n].equilibrium.force).norm(), 1e-8);
    }
  }
}

TEST_P(EveryBlendedField, IsTriLinearWhereBranchesMeetAndSmoothElsewhere) {
  const SpaceTable space = branches(), whole = smooth();
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
    EXPECT_TRUE(std::isnan(sample.error_bound)) << "it never knows one";
  EXPECT_LT(field->evaluate(touching).coverage, 1);
  EXPECT_LE((field->evaluate(away).force - unbroken->evaluate(away).force).norm(), 1e-3);
  EXPECT_EQ(field->evaluate(Vector3d(-0.007, 0.0021, 0)).force,
            unbroken->evaluate(Vector3d(-0.007, 0.0021, 0)).force);
}

TEST_P(EveryBlendedField, NeverErrsMoreThanTriLinearNextToAJump) {
  const auto field = makeForceField(GetParam(), branches()),
             linear = makeForceField("trilinear", branches());
  double worst = 0, worst_linear = 0;
  for (const Vector3d& p : pointsInBall(radius, 4000)) {
    const Vector3d exact = -JumpingEnergy().gradient(p);
    worst = std::max(worst, (field->evaluate(p).force - exact).norm());
    worst_linear = std::max(worst_linear, (linear->evaluate(p).force - exact).norm());
  }
  EXPECT_GT(worst_linear, 2);
  EXPECT_LE(worst, worst_linear + 1e-12);
}

TEST_P(EveryCellField, CoversByTheSolvedCornersAround) {
  const auto field = makeForceField(GetParam(), withHoles());
  const auto expectCoverage = [&](const Vector3d& p, double share) {
    const double coverage = field->evaluate(p).coverage;
    if (GetParam() == "tricubic")
      EXPECT_LE(coverage, share + 1e-12) << "it stands on more than the corners";
    else
      EXPECT_NEAR(coverage, share, 1e-12);
  };
  expectCoverage({-0.0025, 0.0025, 0.0025}, 1);
  expectCoverage({-0.0025, -0.0025, -0.0025}, 7.0 / 8);
  expectCoverage({0.0025, 0.0025, 0.0025}, 6.0 / 8);
  expectCoverage({0.005, 0, 0}, 0);  // on a failed point itself
  EXPECT_TRUE(field->evaluate({0.005, 0, 0}).inside);
  const ForceSample rim = field->evaluate({0.0199, 0.0005, 0.0003});
  EXPECT_TRUE(rim.inside);
  if (GetParam() != "tricubic") {
    EXPECT_GT(rim.coverage, 0.5);
  }
  EXPECT_LT(rim.coverage, 1);
}

TEST(TricubicField, CountsThePointsOfItsDifferencesAsCornersToo) {
  const Vector3d beside_the_hole(-0.0025, 0.0025, 0.0025);
  EXPECT_DOUBLE_EQ(makeForceField("tricubic", smooth())->evaluate(beside_the_hole).coverage, 1);
  EXPECT_LT(makeForceField("tricubic", withHoles())->evaluate(beside_the_hole).coverage, 1);
}

TEST_P(EveryCellField, GoesOnBeyondTheRegionWithAForceThatOnlyGrows) {
  const auto field = makeForceField(GetParam(), withHoles());
  for (const Vector3d& p : pointsInBall(radius, 50)) {
    const Vector3d unit = p.normalized();
    double before = -std::numeric_limits<double>::infinity();
    for (double length = 1.0001 * radius; length < 3 * radius; length += radius / 16) {
      const ForceSample sample = field->evaluate(length * unit);
      EXPECT_FALSE(sample.inside);
      EXPECT_GT(sample.beyond, 0);
      EXPECT_GT(-unit.dot(sample.force), before);
      before = -unit.dot(sample.force);
    }
  }
}

TEST_P(EveryCellField, SaysSomethingFiniteForAnyDisplacement) {
  SpaceTable alone = smooth(), failed_corner = smooth();
  for (std::int32_t n = 1; n < alone.lattice.size(); ++n) alone.points[n] = {};
  failed_corner.points[0] = {};
  const double infinity = std::numeric_limits<double>::infinity(), nan = std::nan("");
  for (const SpaceTable& space : {withHoles(), alone, failed_corner, branches()}) {
    const auto field = makeForceField(GetParam(), space);
    for (const Vector3d& p :
         {Vector3d(0.03, 0, 0), Vector3d(-1e300, 1e300, 0), Vector3d(1e308, 1e308, 1e308),
          Vector3d(nan, 0, 0), Vector3d(0, infinity, -infinity), Vector3d(0.0199, 0.0199, 0.0199),
          Vector3d(0, 0, -0.0200001)}) {
      const ForceSample sample = field->evaluate(p);
      EXPECT_FALSE(sample.inside);
      EXPECT_TRUE(sample.force.allFinite() && sample.stiffness.allFinite()) << p.transpose();
      EXPECT_LT(sample.force.norm(), 1000);
    }
    for (const Vector3d& p : pointsInBall(radius, 100)) {
      const ForceSample sample = field->evaluate(p);
      EXPECT_TRUE(sample.force.allFinite() && sample.stiffness.allFinite());
      EXPECT_LT(sample.force.norm(), 1000);
      EXPECT_GE(sample.coverage, 0);
      EXPECT_LE(sample.coverage, 1);
    }
  }
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
