#include "viewer/fields/answered_region.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/failed_point.hpp"
#include "tests/support/points_in_ball.hpp"
#include "tests/support/sample_dataset.hpp"
#include "viewer/fields/potential_field.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using test::pointsInBall;
using test::radius;
using test::solvedSpace;
using test::StiffeningEnergy;

constexpr double edge_length = 0.005;  ///< m, edge length of the cells

/// Solved up to x = 7.5 mm; beyond that everything failed.
SpaceTable halfSolved() {
  SpaceTable space = solvedSpace(Lattice(radius, edge_length), StiffeningEnergy());
  for (std::int32_t n = 0; n < space.lattice.size(); ++n)
    if (space.lattice.displacement(n).x() > 0.0075) space.points[at(n)] = test::failedPoint();
  return space;
}

RegionEdge edgeOf(const SpaceTable& space, const Vector3d& direction) {
  return AnsweredRegion(CellData(space)).along(DirectionWeights(direction.normalized()));
}

TEST(DirectionWeights, AreAPartitionOfUnityWithExactGradients) {
  for (const Vector3d& p : pointsInBall(1, 200)) {
    const Vector3d unit = p.normalized(), aside = unit.unitOrthogonal();
    const auto sumAt = [](const Vector3d& direction) {  // for any tabulated function
      const DirectionWeights weights(direction.normalized());
      double sum = 0, whole = 0;
      for (std::size_t n = 0; n < weights.size; ++n) {
        sum += weights.weights[n] * std::sin(0.1 * weights.numbers[n]);
        whole += weights.weights[n];
      }
      EXPECT_NEAR(whole, 1, 1e-14);
      return sum;
    };
    const DirectionWeights weights(unit);
    Vector3d gradient = Vector3d::Zero();
    for (std::size_t n = 0; n < weights.size; ++n)
      gradient += std::sin(0.1 * weights.numbers[n]) * weights.gradients[n];
    constexpr double h = 1e-6;
    EXPECT_NEAR((sumAt(unit + h * aside) - sumAt(unit - h * aside)) / (2 * h), gradient.dot(aside),
                1e-6);
    EXPECT_NEAR(gradient.dot(unit), 0, 1e-12);
  }
}

TEST(AnsweredRegion, IsTheBallIfAllPointsAreSolved) {
  const SpaceTable space = solvedSpace(Lattice(radius, edge_length), StiffeningEnergy());
  EXPECT_NEAR(AnsweredRegion(CellData(space)).leastRadius(), radius, 1e-15);
  EXPECT_NEAR(edgeOf(space, {1, 2, 3}).radius, radius, 1e-15);
}

TEST(AnsweredRegion, EndsWhereHalfOfAnAnswerWouldBeExtrapolated) {
  EXPECT_NEAR(edgeOf(halfSolved(), Vector3d::UnitX()).radius, 0.0075, 0.5 * edge_length);
  EXPECT_NEAR(edgeOf(halfSolved(), -Vector3d::UnitX()).radius, radius, 1e-15);
}

TEST(AnsweredRegion, BridgesASinglePointThatFailed) {
  SpaceTable space = solvedSpace(Lattice(radius, edge_length), StiffeningEnergy());
  space.points[at(*space.lattice.indexOf({2, 0, 0}))] = test::failedPoint();
  EXPECT_NEAR(edgeOf(space, Vector3d::UnitX()).radius, radius, 1e-15);
}

class BeyondTheRegion : public ::testing::Test {
 protected:
  /// Displacements beyond the region, up to twice as far.
  std::vector<Vector3d> outside() const {
    std::vector<Vector3d> found;
    for (const Vector3d& p : pointsInBall(2 * radius, 600))
      if (field.evaluate(p).beyond > 1e-4) found.push_back(p);
    return found;
  }
  const PotentialField field = PotentialField(halfSolved());
};

TEST_F(BeyondTheRegion, TheForceIsTheGradientOfOneEnergy) {
  constexpr double h = 1e-7;
  for (const Vector3d& p : outside()) {
    Vector3d gradient;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d d = h * Vector3d::Unit(axis);
      gradient[axis] = (field.evaluate(p + d).energy - field.evaluate(p - d).energy) / (2 * h);
    }
    const ForceSample sample = field.evaluate(p);
    EXPECT_FALSE(sample.inside);
    EXPECT_LE((sample.force + gradient).norm(), 1e-5 * (1 + gradient.norm())) << p.transpose();
  }
}

TEST_F(BeyondTheRegion, EnergyAndForceContinueWithoutAStep) {
  for (const Vector3d& p : outside()) {
    const double beyond = field.evaluate(p).beyond, length = p.norm();
    const Vector3d unit = p / length, edge = (length - beyond) * unit;
    const ForceSample in = field.evaluate(edge - 1e-10 * unit),
                      out = field.evaluate(edge + 1e-10 * unit);
    EXPECT_TRUE(in.inside);
    EXPECT_FALSE(out.inside);
    EXPECT_LE((in.force - out.force).norm(), 1e-5);
    EXPECT_NEAR(in.energy, out.energy, 1e-8);
  }
}

TEST_F(BeyondTheRegion, TheStiffnessJustBeyondTheEdgeIsTheSlopeOfTheForce) {
  double steepest = 0;
  for (const Vector3d& p : outside()) {
    const double length = p.norm(), edge = length - field.evaluate(p).beyond;
    const Vector3d near = (edge + 1e-5) * p / length;
    constexpr double h = 1e-8;
    Eigen::Matrix3d slope;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d d = h * Vector3d::Unit(axis);
      slope.col(axis) = (field.evaluate(near + d).force - field.evaluate(near - d).force) / (2 * h);
    }
    const Eigen::Matrix3d stiffness = field.evaluate(near).stiffness;
    EXPECT_LE((stiffness - slope).norm(), 0.03 * slope.norm()) << p.transpose();
    steepest =
        std::max(steepest, (slope * p.unitOrthogonal()).norm() / (slope * p).norm() * length);
  }
  EXPECT_GT(steepest, 0.3) << "some of the edge is oblique";
}

TEST_F(BeyondTheRegion, PushingDeeperOnlyStiffensAndSoonReachesTheLargestForce) {
  const double max_force = halfSolved().max_force;
  for (const Vector3d& p : outside()) {
    const double length = p.norm(), edge = length - field.evaluate(p).beyond;
    const Vector3d unit = p / length;
    const auto push = [&](double depth) { return -unit.dot(field.evaluate(depth * unit).force); };
    const double h = 1e-6, before = (push(edge) - push(edge - h)) / h;
    for (const double depth : {1e-4, 1e-3, 5e-3, 2e-2})
      EXPECT_GE((push(edge + depth + h) - push(edge + depth)) / h, before - 1) << p.transpose();
    EXPECT_GE(push(edge + 0.1 * radius), push(edge) + 0.99 * max_force);
    EXPECT_LE(push(edge + 0.1 * radius * 1e-3), push(edge) + 0.1 * max_force) << "not at once";
  }
}

TEST_F(BeyondTheRegion, TheBoundGrowsWithTheAddedForce) {
  for (const Vector3d& p : outside()) {
    const ForceSample sample = field.evaluate(p);
    const ForceSample edge = field.evaluate((p.norm() - sample.beyond) * p.normalized());
    EXPECT_GE(sample.error_bound, edge.error_bound + 0.99 * (sample.force - edge.force).norm());
  }
}

}  // namespace
}  // namespace palpate
