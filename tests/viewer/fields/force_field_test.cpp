#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
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
using test::PolynomialEnergy;
using test::radius;
using test::solvedSpace;
using test::StiffeningEnergy;

/// Points of a cube of half edge `reach` metres, from a fixed seed.
std::vector<Vector3d> pointsInCube(double reach, int count = 200) {
  std::mt19937 random(11);
  const auto coordinate = [&] {
    return reach * (static_cast<double>(random()) / 2147483648.0 - 1);
  };
  std::vector<Vector3d> points;
  for (int n = 0; n < count; ++n) {
    const double x = coordinate(), y = coordinate(), z = coordinate();
    points.emplace_back(x, y, z);
  }
  return points;
}

std::unique_ptr<ForceField> fieldOf(std::string_view method, const AnalyticEnergy& energy,
                                    double spacing) {
  const Lattice lattice(radius, spacing);
  return makeForceField(method, solvedSpace(lattice, energy));
}

/// Mean error of the force over points whose cells have complete surroundings.
double forceError(std::string_view method, const AnalyticEnergy& energy, double spacing) {
  const auto field = fieldOf(method, energy, spacing);
  const std::vector<Vector3d> points = pointsInCube(0.005, 1000);
  double sum = 0;
  for (const Vector3d& p : points) {
    const ForceSample sample = field->evaluate(p);
    EXPECT_TRUE(sample.inside);
    sum += (sample.force + energy.gradient(p)).norm();
  }
  return sum / static_cast<double>(points.size());
}

double orderOf(std::string_view method, const AnalyticEnergy& energy) {
  return std::log2(forceError(method, energy, 0.005) / forceError(method, energy, 0.0025));
}

/// E = sum of c x^a y^b z^c with a, b, c <= 1 apart from squares: its force is linear in each
/// coordinate.
class MultilinearForceEnergy : public AnalyticEnergy {
 public:
  double energy(const Vector3d& p) const override { return 40 * p.squaredNorm() + 9e4 * p.prod(); }
  Vector3d gradient(const Vector3d& p) const override {
    return 80 * p + 9e4 * Vector3d(p.y() * p.z(), p.x() * p.z(), p.x() * p.y());
  }
  Matrix3d hessian(const Vector3d& p) const override {
    Matrix3d h;
    h << 80, 9e4 * p.z(), 9e4 * p.y(), 9e4 * p.z(), 80, 9e4 * p.x(), 9e4 * p.y(), 9e4 * p.x(), 80;
    return h;
  }
};

void expectExact(const ForceField& field, const AnalyticEnergy& energy, double reach) {
  for (const Vector3d& p : pointsInCube(reach)) {
    const ForceSample sample = field.evaluate(p);
    if (!sample.inside) continue;
    EXPECT_LE((sample.force + energy.gradient(p)).norm(), 1e-8 * energy.gradient(p).norm());
    EXPECT_LE((sample.stiffness + energy.hessian(p)).norm(), 1e-7 * energy.hessian(p).norm());
  }
}

class EveryField : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(ForceField, EveryField, ::testing::Values("potential", "trilinear"),
                         [](const auto& method) { return method.param; });

TEST_P(EveryField, ReproducesForcesLinearInEachCoordinate) {
  expectExact(*fieldOf(GetParam(), MultilinearForceEnergy(), 0.005), MultilinearForceEnergy(),
              0.02);
}

TEST_P(EveryField, ReturnsTheStoredForcesAtLatticePoints) {
  const Lattice lattice(radius, 0.005);
  const SpaceTable space = solvedSpace(lattice, StiffeningEnergy());
  const auto field = makeForceField(GetParam(), space);
  for (std::int32_t n = 0; n < lattice.size(); ++n) {
    const Vector3d& force = space.points[n].equilibrium.force;
    EXPECT_LE((field->evaluate(lattice.displacement(n)).force - force).norm(),
              1e-9 * (1 + force.norm()));
  }
}

TEST_P(EveryField, ForceIsContinuousAcrossFaces) {
  const double spacing = 0.005;
  const auto field = fieldOf(GetParam(), StiffeningEnergy(), spacing);
  int faces = 0;
  for (const Vector3d& p : pointsInCube(0.018, 2000))
    for (int axis = 0; axis < 3; ++axis) {
      Vector3d low = p, high = p;
      const double face = spacing * std::round(p[axis] / spacing);
      low[axis] = face - 1e-13;
      high[axis] = face + 1e-13;
      const ForceSample below = field->evaluate(low), above = field->evaluate(high);
      if (!below.inside || !above.inside) continue;
      ++faces;
      EXPECT_LE((below.force - above.force).norm(), 1e-9 * below.force.norm() + 1e-12);
    }
  EXPECT_GT(faces, 500);
}

TEST_P(EveryField, StiffnessIsTheDerivativeOfItsForce) {
  const auto field = fieldOf(GetParam(), StiffeningEnergy(), 0.005);
  const double step = 1e-7;
  for (const Vector3d& p : pointsInCube(0.009)) {
    Matrix3d differences;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d d = step * Vector3d::Unit(axis);
      differences.col(axis) =
          (field->evaluate(p + d).force - field->evaluate(p - d).force) / (2 * step);
    }
    EXPECT_LE((field->evaluate(p).stiffness - differences).norm(), 1e-5 * differences.norm());
  }
}

TEST_P(EveryField, SaysWhatOfTheBallStandsOnSolvedCorners) {
  const Lattice lattice(radius, 0.005);
  SpaceTable space = solvedSpace(lattice, StiffeningEnergy());
  space.points[*lattice.indexOf({1, 1, 1})].tag = Tag::failed;
  space.points[*lattice.indexOf({-1, 0, 0})].tag = Tag::terminating;
  const auto field = makeForceField(GetParam(), space);
  const auto coverage = [&](const Vector3d& p) { return field->evaluate(p).coverage; };
  EXPECT_NEAR(coverage({0.0025, 0.0025, 0.0025}), 7.0 / 8, 1e-12) << "one corner of eight failed";
  EXPECT_NEAR(coverage({-0.0026, 0.0024, 0.0025}), 1, 1e-12) << "terminating points are solved";
  EXPECT_NEAR(coverage({0.005, 0.005, 0}), 1, 1e-12);
  EXPECT_NEAR(coverage({0.005, 0.005, 0.005}), 0, 1e-12) << "on the failed point itself";
  EXPECT_TRUE(field->evaluate({0.005, 0.005, 0.005}).inside);
  EXPECT_TRUE(field->evaluate({0.0199, 0, 0}).inside) << "at the rim, inside the ball";
  EXPECT_FALSE(field->evaluate({0.021, 0, 0}).inside) << "outside the ball";
}

TEST_P(EveryField, SaysSomethingFiniteForAnyDisplacement) {
  const auto field = fieldOf(GetParam(), StiffeningEnergy(), 0.01);
  const double infinity = std::numeric_limits<double>::infinity(), nan = std::nan("");
  for (const Vector3d& p :
       {Vector3d(0.03, 0, 0), Vector3d(-1e300, 1e300, 0), Vector3d(1e308, 1e308, 1e308),
        Vector3d(nan, 0, 0), Vector3d(0, infinity, -infinity), Vector3d(0.0199, 0.0199, 0.0199)}) {
    const ForceSample sample = field->evaluate(p);
    EXPECT_FALSE(sample.inside);
    EXPECT_TRUE(sample.force.allFinite() && sample.stiffness.allFinite()) << p.transpose();
    EXPECT_LT(sample.force.norm(), 1000);
  }
}

TEST_P(EveryField, NeedsASolvedPoint) {
  const Lattice lattice(radius, 0.01);
  SpaceTable space = solvedSpace(lattice, StiffeningEnergy());
  for (PointRecord& point : space.points) point = {};
  test::expectError(ExitCode::failed, [&] { makeForceField(GetParam(), space); },
                    {"tip", "no lattice point was solved"});
}

TEST(ForceField, RefusesAnUnknownMethodNamingTheKnown) {
  const Lattice lattice(radius, 0.01);
  test::expectBadInput([&] { makeForceField("cubic", solvedSpace(lattice, StiffeningEnergy())); },
                       {"\"cubic\"", "potential, trilinear"});
}

TEST(TrilinearField, ConvergesWithTheSquareOfTheSpacing) {
  EXPECT_NEAR(orderOf("trilinear", StiffeningEnergy()), 2, 0.1);
}

TEST(PotentialField, ReproducesCubicEnergiesWhereverItCovers) {
  const PolynomialEnergy cubic(3, radius);
  expectExact(*fieldOf("potential", cubic, 0.005), cubic, 0.02);
}

TEST(PotentialField, ReproducesQuarticEnergiesInTheInterior) {
  const PolynomialEnergy quartic(4, radius);
  expectExact(*fieldOf("potential", quartic, 0.005), quartic, 0.005);
}

TEST(PotentialField, ReproducesCubicEnergiesNextToFailedPoints) {
  const Lattice lattice(radius, 0.005);
  const PolynomialEnergy cubic(3, radius);
  SpaceTable space = solvedSpace(lattice, cubic);
  for (const LatticePoint& hole :
       {LatticePoint{1, 0, 0}, LatticePoint{-1, -1, 0}, LatticePoint{0, 1, 2}}) {
    PointRecord& point = space.points[*lattice.indexOf(hole)];
    point = {};
    point.tag = Tag::failed;
    point.equilibrium.force.setConstant(1e9);  // must not be looked at
  }
  expectExact(*makeForceField("potential", space), cubic, 0.015);
}

TEST(PotentialField, ConvergesAtLeastWithTheFourthPowerOfTheSpacing) {
  EXPECT_GT(orderOf("potential", StiffeningEnergy()), 3.8);
  EXPECT_LT(forceError("potential", StiffeningEnergy(), 0.005),
            1e-2 * forceError("trilinear", StiffeningEnergy(), 0.005));
}

TEST(PotentialField, ForceIsMinusTheGradientOfItsEnergy) {
  const auto field = fieldOf("potential", StiffeningEnergy(), 0.005);
  const double step = 1e-6;
  for (const Vector3d& p : pointsInCube(0.009)) {
    Vector3d differences;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d d = step * Vector3d::Unit(axis);
      differences[axis] =
          (field->evaluate(p - d).energy - field->evaluate(p + d).energy) / (2 * step);
    }
    const ForceSample sample = field->evaluate(p);
    EXPECT_LE((sample.force - differences).norm(), 1e-6 * sample.force.norm());
    EXPECT_EQ(sample.stiffness, sample.stiffness.transpose());
  }
}

/// Work of the field along a circle through many cells, relative to the work of its absolute value.
double relativeLoopWork(const ForceField& field) {
  const int steps = 20000;
  const Vector3d u = Vector3d(1, 2, 0.5).normalized(),
                 v = u.cross(Vector3d(0, 0.3, 1)).normalized();
  double work = 0, total = 0;
  for (int n = 0; n < steps; ++n) {
    const double angle = 2 * M_PI * (n + 0.5) / steps;
    const Vector3d p = 0.009 * (std::cos(angle) * u + std::sin(angle) * v);
    const Vector3d step = 0.009 * 2 * M_PI / steps * (-std::sin(angle) * u + std::cos(angle) * v);
    const double part = field.evaluate(p).force.dot(step);
    work += part;
    total += std::abs(part);
  }
  return std::abs(work) / total;
}

TEST(PotentialField, ReturnsNoWorkFromAClosedLoopWhereTrilinearDoes) {
  EXPECT_LT(relativeLoopWork(*fieldOf("potential", StiffeningEnergy(), 0.005)), 1e-9);
  EXPECT_GT(relativeLoopWork(*fieldOf("trilinear", StiffeningEnergy(), 0.005)), 1e-6);
}

TEST(PotentialField, StiffnessIsContinuousAcrossFaces) {
  const double spacing = 0.005;
  const auto field = fieldOf("potential", StiffeningEnergy(), spacing);
  for (const Vector3d& p : pointsInCube(0.009)) {
    Vector3d low = p, high = p;
    low.x() = -1e-13;
    high.x() = 1e-13;
    const Matrix3d below = field->evaluate(low).stiffness, above = field->evaluate(high).stiffness;
    EXPECT_LE((below - above).norm(), 1e-8 * below.norm());
  }
}

}  // namespace
}  // namespace palpate
