#include "viewer/fields/pressure_field.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/uneven_spaces.hpp"
#include "viewer/fields/displacement_field.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using test::holedSpace;
using test::pointsInBall;
using test::radius;
using test::refinedSpace;
using test::solvedSpace;
using test::StiffeningEnergy;

constexpr std::size_t nodes = 4;
using Pressures = std::array<float, nodes>;

/// Pa, curved in p, of both signs, and different for each node.
float pressureOf(const Vector3d& p, std::size_t node) {
  const Vector3d q = (40 + 5 * static_cast<double>(node)) * p;
  return static_cast<float>(2000 * std::sin(q.x() + 0.5 * q.y()) - 700 * std::cos(q.z() - q.y()));
}

/// NaN at unsolved points.
std::vector<float> rowsOf(const SpaceTable& space) {
  std::vector<float> rows;
  for (std::int32_t n = 0; n < space.lattice.size(); ++n)
    for (std::size_t node = 0; node < nodes; ++node)
      rows.push_back(isSolved(space.points[at(n)].tag)
                         ? pressureOf(space.lattice.displacement(n), node)
                         : std::nanf(""));
  return rows;
}

Pressures pressuresAt(const PressureField& field, const Vector3d& p) {
  Pressures out = {0, 0, 0, 0};
  field.add(p, 1, out);
  return out;
}

TEST(PressureField, IsTheStoredPressureAtEveryLatticePointToTheLastBit) {
  const SpaceTable space = holedSpace();
  const PressureField field(space, rowsOf(space));
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    if (!isSolved(space.points[at(n)].tag)) continue;
    const Vector3d p = space.lattice.displacement(n);
    const Pressures found = pressuresAt(field, p);
    for (std::size_t node = 0; node < nodes; ++node) EXPECT_EQ(found[node], pressureOf(p, node));
  }
}

/// Equal to the displacement field for the same numbers: in holes, levels, branches, at the
/// boundary and beyond it.
TEST(PressureField, InterpolatesAsTheDisplacementField) {
  for (const SpaceTable& space : {holedSpace(), refinedSpace(0.005), test::branchedSpace()}) {
    const std::vector<float> rows = rowsOf(space);
    // Taken as metres, the numbers are so large that no mode is left out.
    std::vector<float> displacements;
    for (const float pressure : rows) displacements.insert(displacements.end(), 3, pressure);
    const PressureField field(space, rows);
    const DisplacementField shape(space, displacements);
    std::array<float, 3 * nodes> seen;
    for (const Vector3d& p : pointsInBall(1.3 * radius)) {
      const Pressures found = pressuresAt(field, p);
      shape.evaluate(p, seen);
      for (std::size_t node = 0; node < nodes; ++node)
        EXPECT_NEAR(found[node], seen[3 * node], 0.02) << p.transpose();
    }
  }
}

TEST(PressureField, AddsItsShareToTheOutput) {
  const SpaceTable space = solvedSpace(Lattice(radius, 0.01), StiffeningEnergy());
  const PressureField field(space, rowsOf(space));
  const Vector3d p(0.003, -0.002, 0.007);
  Pressures out = {1, 2, 3, 4};
  field.add(p, 0.25, out);
  const Pressures whole = pressuresAt(field, p);
  for (std::size_t node = 0; node < nodes; ++node)
    EXPECT_NEAR(out[node], static_cast<float>(node + 1) + 0.25F * whole[node], 1e-3);
}

TEST(PressureField, IsFiniteForAnyDisplacementAndAtRestForNaN) {
  const SpaceTable space = solvedSpace(Lattice(radius, 0.01), StiffeningEnergy());
  const PressureField field(space, rowsOf(space));
  const double infinity = std::numeric_limits<double>::infinity(), nan = std::nan("");
  for (const Vector3d& p : {Vector3d(1e308, -1e308, 0), Vector3d(0, 0, -1e9)})
    for (const float pressure : pressuresAt(field, p)) EXPECT_LE(std::abs(pressure), 8000);
  for (const Vector3d& p : {Vector3d(infinity, 0, 0), Vector3d(0, nan, 0)})
    for (const float pressure : pressuresAt(field, p)) EXPECT_TRUE(std::isfinite(pressure));
  EXPECT_EQ(pressuresAt(field, {0, nan, 0}), pressuresAt(field, Vector3d::Zero()));
}

}  // namespace
}  // namespace palpate
