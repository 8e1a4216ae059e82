#include "viewer/potential_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/support/sample_dataset.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;

constexpr double radius = 0.06, spacing = 0.02;

/// Cells of three sizes, two failed points, the rim as it is.
SpaceTable refinedSpace() {
  const std::vector<LatticeCell> splits = {{{0, 0, 0}, 0}, {{1024, 0, 0}, 0}, {{512, 512, 512}, 1}};
  Lattice lattice(radius, spacing, 1024);
  for (const LatticeCell& cell : splits) {
    const std::int32_t half = 512 >> cell.level;
    for (int n = 0; n < 27; ++n) {
      const LatticePoint point = {cell.lowest[0] + half * (n % 3), cell.lowest[1] + half * (n / 3 % 3),
                                  cell.lowest[2] + half * (n / 9)};
      if (!lattice.indexOf(point)) lattice.add(point);
    }
  }
  SpaceTable space = test::solvedSpace(lattice, test::StiffeningEnergy());
  space.splits = splits;
  for (const LatticePoint& hole : {LatticePoint{-1024, 0, 0}, LatticePoint{1024, 512, 512}}) {
    PointRecord& point = space.points[*lattice.indexOf(hole)];
    point = {};
    point.tag = Tag::failed;
  }
  return space;
}

Vector3d inBall(std::mt19937& random) {
  std::uniform_real_distribution<double> coordinate(-radius, radius);
  for (;;) {
    const double x = coordinate(random), y = coordinate(random), z = coordinate(random);
    if (Vector3d(x, y, z).norm() < 0.999 * radius) return {x, y, z};
  }
}

TEST(PotentialField, IsContinuousAcrossRefinedCellsTheRimAndFailedPoints) {
  const PotentialField field(refinedSpace());
  std::mt19937 random(4);
  for (int n = 0; n < 6000; ++n) {
    Vector3d low = inBall(random), high;
    const int axis = n % 3;
    const double grid = n % 2 == 0 ? spacing : spacing / 4;
    const double face = grid * std::round(low[axis] / grid);
    high = low;
    low[axis] = face - 1e-12;
    high[axis] = face + 1e-12;
    const ForceSample below = field.evaluate(low), above = field.evaluate(high);
    EXPECT_LE((below.force - above.force).norm(), 1e-7) << low.transpose();
    EXPECT_LE((below.stiffness - above.stiffness).norm(), 1e-5) << low.transpose();
  }
}

TEST(PotentialField, IsContinuousOverTheSphere) {
  const PotentialField field(refinedSpace());
  std::mt19937 random(6);
  for (int n = 0; n < 1000; ++n) {
    const Vector3d direction = inBall(random).normalized();
    const ForceSample in = field.evaluate(direction * (radius - 1e-12)),
                      out = field.evaluate(direction * (radius + 1e-12));
    EXPECT_TRUE(in.inside);
    EXPECT_LE((in.force - out.force).norm(), 1e-7);
  }
}

TEST(PotentialField, AnswersInTheWholeBallWithABoundThatHolds) {
  const PotentialField field(refinedSpace());
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

}  // namespace
}  // namespace palpate
