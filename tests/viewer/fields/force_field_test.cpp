#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/expect_error.hpp"
#include "tests/support/uneven_spaces.hpp"
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

/// Points in a cube of half edge `reach` metres, from a fixed seed.
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

/// E = sum of c x^a y^b z^c with a, b, c <= 1, plus squares: its force is linear in each
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

/// Properties of every method, on spaces with holes, cells of several sizes and branches.
class EveryField : public ::testing::TestWithParam<std::string> {
 protected:
  static std::unique_ptr<ForceField> fieldOf(const SpaceTable& space) {
    return makeForceField(GetParam(), space);
  }
  inline static const std::vector<SpaceTable> spaces = {
      test::holedSpace(),
      test::splitSpace(Lattice(radius, 0.005, 1024), test::three_sizes, StiffeningEnergy()),
      test::branchedSpace()};
};
INSTANTIATE_TEST_SUITE_P(ForceField, EveryField, ::testing::ValuesIn(forceFieldMethods()),
                         [](const auto& method) {
                           std::string name = method.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST_P(EveryField, HasTheNameOfItsMethod) { EXPECT_EQ(fieldOf(spaces[0])->name(), GetParam()); }

TEST_P(EveryField, ReturnsTheStoredForcesAtSolvedPoints) {
  for (const SpaceTable& space : spaces) {
    // A point on the face of a larger cell is hanging: that cell's interpolation determines its
    // force.
    if (!space.splits.empty() && !GetParam().starts_with("rbf")) continue;
    const auto field = fieldOf(space);
    for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
      const ForceSample sample = field->evaluate(space.lattice.displacement(n));
      if (!isSolved(space.points[at(n)].tag) || sample.beyond > 0) continue;
      EXPECT_LE((sample.force - space.points[at(n)].equilibrium.force).norm(), 1e-8);
    }
  }
}

TEST_P(EveryField, ForceIsContinuousOverFacesAndTheSphere) {
  for (const SpaceTable& space : spaces) {
    const auto field = fieldOf(space);
    const auto jump = [&](const Vector3d& p, const Vector3d& step) {  // beyond that of the
                                                                      // stiffness
      const ForceSample low = field->evaluate(p - step), high = field->evaluate(p + step);
      // answered_region_test.cpp tests what lies beyond the edge.
      if (low.beyond > 1e-11 || high.beyond > 1e-11) return 0.0;
      return (high.force - low.force).norm() - 2 * low.stiffness.norm() * step.norm();
    };
    for (const Vector3d& p : pointsInBall(radius, 2000)) {
      for (int axis = 0; axis < 3; ++axis) {
        Vector3d on_face = p;
        on_face[axis] = 0.00125 * std::round(p[axis] / 0.00125);
        EXPECT_LE(jump(on_face, 1e-12 * Vector3d::Unit(axis)), 1e-8) << on_face.transpose();
      }
      EXPECT_LE(jump(radius * p.normalized(), 1e-12 * p.normalized()), 1e-8) << "at the sphere";
    }
  }
}

TEST_P(EveryField, StiffnessIsTheDerivativeOfItsForceInTheRegion) {
  constexpr double step = 1e-8;
  for (const SpaceTable& space : spaces) {
    const auto field = fieldOf(space);
    for (const Vector3d& p : pointsInBall(radius)) {
      const ForceSample sample = field->evaluate(p);
      if (sample.beyond > 0) continue;
      Matrix3d differences;
      for (int axis = 0; axis < 3; ++axis) {
        const Vector3d d = step * Vector3d::Unit(axis);
        differences.col(axis) =
            (field->evaluate(p + d).force - field->evaluate(p - d).force) / (2 * step);
      }
      EXPECT_LE((sample.stiffness - differences).norm(), 1e-4 * (1 + differences.norm()))
          << p.transpose();
    }
  }
}

TEST_P(EveryField, CoverageIsTheShareOfSolvedCorners) {
  SpaceTable space = spaces[0];
  space.points[at(*space.lattice.indexOf({-1, 1, 1}))].tag = Tag::terminating;
  const auto field = fieldOf(space);
  const auto expectCoverage = [&](const Vector3d& p, double share) {
    const double coverage = field->evaluate(p).coverage;
    if (GetParam() == "tricubic")
      EXPECT_LE(coverage, share + 1e-12) << "it uses more points than the corners";
    else
      EXPECT_NEAR(coverage, share, 1e-12);
  };
  expectCoverage({-0.0025, 0.0025, 0.0025}, 1);  // terminating points count as solved
  expectCoverage({-0.0025, -0.0025, -0.0025}, 7.0 / 8);
  expectCoverage({0.0025, 0.0025, 0.0025}, 6.0 / 8);
  expectCoverage({0.005, 0, 0}, 0);  // at a failed point itself
  EXPECT_TRUE(field->evaluate({0.005, 0, 0}).inside);
  const ForceSample rim = field->evaluate({0.0199, 0.0005, 0.0003});
  EXPECT_TRUE(rim.inside);
  EXPECT_TRUE(rim.coverage > 0.5 || GetParam() == "tricubic");
  EXPECT_LT(rim.coverage, 1);
}

TEST_P(EveryField, ContinuesBeyondTheRegionWithAGrowingForce) {
  const auto field = fieldOf(spaces[0]);
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

TEST_P(EveryField, IsFiniteForAnyDisplacement) {
  SpaceTable few = solvedSpace(Lattice(radius, 0.005), StiffeningEnergy()), no_rest = few;
  for (std::int32_t n = 4; n < few.lattice.size(); ++n) few.points[at(n)] = {};
  no_rest.points[0] = {};
  std::vector<SpaceTable> all = spaces;
  all.insert(all.end(), {few, no_rest});
  const double infinity = std::numeric_limits<double>::infinity(), nan = std::nan("");
  for (const SpaceTable& space : all) {
    const auto field = fieldOf(space);
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
      EXPECT_TRUE(sample.coverage >= 0 && sample.coverage <= 1);
    }
  }
}

TEST_P(EveryField, NeedsASolvedPoint) {
  SpaceTable space = solvedSpace(Lattice(radius, 0.01), StiffeningEnergy());
  for (PointRecord& point : space.points) point = {};
  test::expectError(ExitCode::failed, [&] { fieldOf(space); }, {"tip"});
}

TEST(ForceField, PotentialAndTrilinearReproduceForcesLinearInEachCoordinate) {
  for (const char* method : {"potential", "trilinear"})
    expectExact(*fieldOf(method, MultilinearForceEnergy(), 0.005), MultilinearForceEnergy(), 0.02);
}

TEST(ForceField, RefusesAnUnknownMethodListingTheValidOnes) {
  test::expectBadInput([&] { makeForceField("cubic", test::branchedSpace()); },
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
  const PolynomialEnergy cubic(3, radius);
  const SpaceTable space = test::without(solvedSpace(Lattice(radius, 0.005), cubic),
                                         {{1, 0, 0}, {-1, -1, 0}, {0, 1, 2}});
  expectExact(*makeForceField("potential", space), cubic, 0.015);
}

TEST(PotentialField, ConvergesAtLeastWithTheFourthPowerOfTheSpacing) {
  EXPECT_GT(orderOf("potential", StiffeningEnergy()), 3.8);
  EXPECT_LT(forceError("potential", StiffeningEnergy(), 0.005),
            1e-2 * forceError("trilinear", StiffeningEnergy(), 0.005));
}

}  // namespace
}  // namespace palpate
