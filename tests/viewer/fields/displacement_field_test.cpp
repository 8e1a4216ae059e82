#include "viewer/fields/displacement_field.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "tests/support/expect_error.hpp"
#include "tests/support/uneven_spaces.hpp"

namespace palpate {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::holedSpace;
using test::pointsInBall;
using test::radius;
using test::refinedSpace;
using test::solvedSpace;
using test::StiffeningEnergy;

/// Motion of a node as a function of the active node's displacement.
using Motion = std::function<Vector3d(const Vector3d&)>;

Motion linearMotion() {
  Matrix3d a;
  a << 1, 0.2, 0, -0.1, 0.7, 0.3, 0.05, 0, 0.9;
  return [a](const Vector3d& p) -> Vector3d { return a * p + Vector3d(0.001, 0, -0.002); };
}

Motion curvedMotion() {
  return [](const Vector3d& p) -> Vector3d {
    const Vector3d q = 60 * p;
    return 0.01 * Vector3d(std::sin(q.x() + 0.5 * q.y()), std::cos(q.y() - q.z()),
                           std::sin(q.x()) * std::cos(q.z() + 0.3));
  };
}

constexpr std::size_t nodes = 5;

/// Rows of nodes that move by `motion`, node n by n + 1 times as much; NaN at unsolved points.
std::vector<float> rowsOf(const SpaceTable& space, const Motion& motion) {
  std::vector<float> rows;
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    const Vector3d at = motion(space.lattice.displacement(n));
    for (std::size_t node = 0; node < nodes; ++node)
      for (int axis = 0; axis < 3; ++axis)
        rows.push_back(isSolved(space.points[n].tag)
                           ? static_cast<float>((static_cast<double>(node) + 1) * at[axis])
                           : std::nanf(""));
  }
  return rows;
}

DisplacementField fieldOf(const SpaceTable& space, const Motion& motion) {
  return DisplacementField(space, rowsOf(space, motion));
}

std::array<float, 3 * nodes> shapeAt(const DisplacementField& field, const Vector3d& p) {
  std::array<float, 3 * nodes> shape;
  shape.fill(std::nanf(""));
  field.evaluate(p, shape);
  return shape;
}

double errorAt(const DisplacementField& field, const Motion& motion, const Vector3d& p) {
  const auto shape = shapeAt(field, p);
  double largest = 0;
  for (std::size_t node = 0; node < nodes; ++node)
    for (std::size_t axis = 0; axis < 3; ++axis)
      largest = std::max(largest, std::abs(static_cast<double>(shape[3 * node + axis]) /
                                               (static_cast<double>(node) + 1) -
                                           motion(p)[static_cast<Eigen::Index>(axis)]));
  return largest;
}

TEST(DisplacementField, ReturnsTheStoredShapesAtLatticePoints) {
  const SpaceTable space = holedSpace();
  const DisplacementField field = fieldOf(space, curvedMotion());
  for (std::int32_t n = 0; n < space.lattice.size(); ++n)
    if (isSolved(space.points[n].tag)) {
      EXPECT_LE(errorAt(field, curvedMotion(), space.lattice.displacement(n)), 1e-8);
    }
}

TEST(DisplacementField, KeepsAsManyModesAsStoredShapesNeedForItsAccuracy) {
  const SpaceTable space = solvedSpace(Lattice(radius, 0.005), StiffeningEnergy());
  const double allowed = DisplacementField::largest_shape_error * radius;
  EXPECT_EQ(fieldOf(space, curvedMotion()).modeCount(), 3) << "all nodes move equally";
  for (const double noise : {0.4, 20.0}) {
    std::vector<float> rows = rowsOf(space, curvedMotion());
    std::mt19937 random(1);
    std::uniform_real_distribution<float> spread(-1, 1);
    for (float& value : rows) value += static_cast<float>(noise * allowed) * spread(random);
    const DisplacementField field(space, rows);
    if (noise < 1) {
      EXPECT_EQ(field.modeCount(), 3);
    } else {
      EXPECT_GT(field.modeCount(), 5);
    }
    for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
      const auto shape = shapeAt(field, space.lattice.displacement(n));
      for (std::size_t i = 0; i < shape.size(); ++i)
        EXPECT_NEAR(shape[i], rows[at(n) * shape.size() + i], 1.01 * allowed);
    }
  }
}

TEST(DisplacementField, ReproducesLinearMotionsOverTheWholeBallHolesIncluded) {
  const SpaceTable space = holedSpace();
  const DisplacementField field = fieldOf(space, linearMotion());
  for (const Vector3d& p : pointsInBall(radius)) EXPECT_LE(errorAt(field, linearMotion(), p), 1e-8);
}

TEST(DisplacementField, ConvergesWithTheSquareOfTheSpacing) {
  std::array<double, 2> error = {0, 0};
  for (std::size_t n = 0; n < 2; ++n) {
    const DisplacementField field = fieldOf(
        solvedSpace(Lattice(radius, n == 0 ? 0.005 : 0.0025), StiffeningEnergy()), curvedMotion());
    for (const Vector3d& p : pointsInBall(0.009)) error[n] += errorAt(field, curvedMotion(), p);
  }
  EXPECT_NEAR(std::log2(error[0] / error[1]), 2, 0.3);
}

TEST(DisplacementField, IsContinuousAcrossLeavesHolesLevelsAndTheSphere) {
  for (const SpaceTable& space : {holedSpace(), refinedSpace(0.005), test::branchedSpace()}) {
    const DisplacementField field = fieldOf(space, curvedMotion());
    for (Vector3d p : pointsInBall(radius, 500))
      for (int axis = 0; axis < 3; ++axis) {
        p[axis] = 0.0025 * std::round(p[axis] / 0.0025);
        const Vector3d step = 1e-12 * Vector3d::Unit(axis);
        const auto below = shapeAt(field, p - step), above = shapeAt(field, p + step);
        for (std::size_t i = 0; i < below.size(); ++i) EXPECT_NEAR(below[i], above[i], 1e-7);
      }
  }
}

TEST(DisplacementField, IsFiniteForAnyDisplacement) {
  const SpaceTable space = solvedSpace(Lattice(radius, 0.01), StiffeningEnergy());
  const double infinity = std::numeric_limits<double>::infinity(), nan = std::nan("");
  const DisplacementField field = fieldOf(space, linearMotion());
  std::array<float, 3 * nodes> shape;
  EXPECT_TRUE(field.evaluate({0.019, 0, 0}, shape));
  for (const Vector3d& p : {Vector3d(0.03, 0, 0), Vector3d(1e308, -1e308, 0),
                            Vector3d(infinity, 0, 0), Vector3d(nan, 0, 0), Vector3d(0, 0, -1e9)}) {
    shape.fill(std::nanf(""));
    EXPECT_FALSE(field.evaluate(p, shape));
    for (const float x : shape) EXPECT_LE(std::abs(x), 1) << p.transpose();
  }
  EXPECT_NEAR(shapeAt(field, {0.03, 0, 0})[0], shapeAt(field, {0.02, 0, 0})[0], 1e-7)
      << "on the sphere";
}

TEST(DisplacementField, WorksWithASinglePoint) {
  SpaceTable space = solvedSpace(Lattice(radius, 0.01), StiffeningEnergy());
  for (std::int32_t n = 1; n < space.lattice.size(); ++n) space.points[n] = {};
  const DisplacementField field = fieldOf(space, linearMotion());
  EXPECT_NEAR(shapeAt(field, {0.003, -0.002, 0.004})[0], linearMotion()({0, 0, 0})[0], 1e-8);
}

TEST(DisplacementField, IsZeroIfNothingMoves) {
  const SpaceTable space = solvedSpace(Lattice(radius, 0.01), StiffeningEnergy());
  const std::vector<float> rows(rowsOf(space, linearMotion()).size(), 0.0f);
  const DisplacementField field(space, rows);
  EXPECT_EQ(field.modeCount(), 0u);
  std::array<float, 3 * nodes> shape;
  shape.fill(1);
  EXPECT_TRUE(field.evaluate({0.003, -0.002, 0.004}, shape));
  EXPECT_THAT(shape, testing::Each(0.0f));
}

TEST(DisplacementField, RefusesMismatchedRows) {
  const SpaceTable space = solvedSpace(Lattice(radius, 0.01), StiffeningEnergy());
  const std::vector<float> rows = rowsOf(space, linearMotion());
  const std::span<const float> all = rows;
  test::expectError(ExitCode::failed, [&] { DisplacementField(space, all.first(all.size() - 1)); },
                    {"33 lattice points"});
  test::expectError(ExitCode::failed, [&] { DisplacementField(space, std::span<const float>()); },
                    {"0"});
  SpaceTable unsolved = space;
  for (PointRecord& point : unsolved.points) point = {};
  test::expectError(ExitCode::failed, [&] { DisplacementField(unsolved, all); },
                    {"no lattice point was solved"});
}

}  // namespace
}  // namespace palpate
