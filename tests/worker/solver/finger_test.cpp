// Compares the forces of a finger's equilibrium with differences of its energy E(s, p) in place and
// displacement.

#include "common/problem/finger.hpp"

#include <gtest/gtest.h>

#include "tests/support/expect_error.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/problems.hpp"
#include "tests/worker/solver/start_at_rest.hpp"
#include "worker/solver/path.hpp"

namespace palpate {
namespace {

constexpr double pad_radius = 0.06;
const Eigen::Vector3d pushed(-0.008, 0.012, 0.006);

class FingerOnABlob : public ::testing::Test {
 protected:
  void clamp(Scene scene) {
    solver_.reset();
    problem_ = test::fingeredBlob(pad_radius, std::move(scene));
    solver_.emplace(problem_, chooseKernels());
  }
  const Eigen::Vector3d& center() const { return problem_.active[0].finger->center; }

  Equilibrium equilibriumAt(const Eigen::Vector3d& s, const Eigen::Vector3d& p) {
    solver_->placeFinger("here", {s, pad_radius});
    const Outcome outcome = walk(*solver_, test::startAtRest(*solver_), p, 2).outcome;
    EXPECT_TRUE(outcome.converged()) << describe(outcome.failure());
    return outcome.equilibrium();
  }

  static void expectChange(const SymmetricSlope& slope, int axis, const Eigen::Matrix3d& difference,
                           double tolerance) {
    for (std::size_t c = 0; c < symmetric_axes.size(); ++c)
      EXPECT_NEAR(slope(static_cast<Eigen::Index>(c), axis),
                  difference(symmetric_axes[c][0], symmetric_axes[c][1]), tolerance * slope.norm());
  }

  void expectDerivativesOfOneEnergy() {
    constexpr double h = 1e-5;
    const Eigen::Vector3d s = center();
    const Equilibrium here = equilibriumAt(s, pushed);
    ASSERT_GT(here.drive.norm(), 0.01 * here.force.norm());
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d e = h * Eigen::Vector3d::Unit(i);
      const Equilibrium up = equilibriumAt(s, pushed + e), down = equilibriumAt(s, pushed - e);
      EXPECT_NEAR((up.energy - down.energy) / (2 * h), -here.force[i], 1e-6 * here.force.norm());
      EXPECT_LT(((up.force - down.force) / (2 * h) - here.stiffness.col(i)).norm(),
                1e-6 * here.stiffness.norm());
      EXPECT_LT(((up.drive - down.drive) / (2 * h) - here.drive_stiffness.col(i)).norm(),
                1e-6 * here.drive_stiffness.norm());
      const Equilibrium on = equilibriumAt(s + e, pushed), back = equilibriumAt(s - e, pushed);
      EXPECT_NEAR((on.energy - back.energy) / (2 * h), -here.drive[i], 1e-6 * here.drive.norm());
      EXPECT_LT(
          ((on.force - back.force) / (2 * h) - here.drive_stiffness.row(i).transpose()).norm(),
          1e-6 * here.drive_stiffness.norm());
      // The tolerance covers the jumps of the weights' curvature (finger_weights_test.cpp).
      EXPECT_LT(((on.drive - back.drive) / (2 * h) - here.drive_slope.col(i)).norm(),
                1e-2 * here.drive_slope.norm());
      expectChange(here.stiffness_by_p, i, (up.stiffness - down.stiffness) / (2 * h), 1e-5);
      expectChange(here.stiffness_by_s, i, (on.stiffness - back.stiffness) / (2 * h), 1e-5);
      expectChange(here.drive_slope_by_p, i, (up.drive_slope - down.drive_slope) / (2 * h), 1e-5);
    }
    EXPECT_EQ(here.drive_slope, here.drive_slope.transpose());
  }

  Problem problem_;
  std::optional<TransitionSolver> solver_;
};

TEST_F(FingerOnABlob, ForcesAreMinusTheGradientsOfOneEnergy) {
  Scene quadratic = test::mooneyRivlinScene(), heavy = quadratic;
  quadratic.discretization = {DisplacementSpace::p2, PressureSpace::p1};
  heavy.regions[0].material.density = 1060;
  heavy.gravity = {0, 0, -5};
  for (const Scene& scene : {test::mooneyRivlinScene(), quadratic, heavy}) {
    clamp(scene);
    expectDerivativesOfOneEnergy();
  }
}

/// Pushes to opposite sides make different fibres taut.
TEST_F(FingerOnABlob, FiberStiffnessAtRestIsNearlyTheMeanOfBothSides) {
  constexpr double h = 1e-5;
  Scene scene = test::mooneyRivlinScene();
  scene.regions[0].material = {.law = LawName::holzapfel_gasser_ogden,
                               .mu = 3870,
                               .k1 = 20000,
                               .k2 = 2.7,
                               .fibers = {Eigen::Vector3d(1, 0.2, 0.1).normalized()}};
  clamp(scene);
  const Equilibrium rest = equilibriumAt(center(), Eigen::Vector3d::Zero());
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d e = h * Eigen::Vector3d::Unit(i);
    const Equilibrium up = equilibriumAt(center(), e), down = equilibriumAt(center(), -e);
    const double pull = -up.force[i] / h, push = down.force[i] / h;
    EXPECT_GT(std::max(pull, push), 1.7 * std::min(pull, push));
    EXPECT_NEAR(-rest.stiffness(i, i), (pull + push) / 2, 0.1 * (pull + push) / 2);
    // The stored third derivatives are such jumps of the tangent, divided by the step of the
    // difference.
    EXPECT_GT(rest.stiffness_by_p.norm() * pad_radius, 100 * rest.stiffness.norm());
  }
}

TEST_F(FingerOnABlob, ConfigurationalForceVanishesWithoutDisplacement) {
  clamp(test::mooneyRivlinScene());
  const Equilibrium rest = equilibriumAt(center(), Eigen::Vector3d::Zero());
  EXPECT_LT(rest.drive.norm(), 1e-12);
  EXPECT_LT(rest.drive_stiffness.norm(), 1e-9);
}

TEST_F(FingerOnABlob, APlacedFingerEqualsThatOfAScene) {
  clamp(test::mooneyRivlinScene());
  const Equilibrium placed = equilibriumAt(center(), pushed);
  solver_->chooseTool(0);
  const Outcome chosen = walk(*solver_, test::startAtRest(*solver_), pushed, 2).outcome;
  EXPECT_EQ(chosen.equilibrium().force, placed.force);
  EXPECT_EQ(chosen.equilibrium().drive_slope, placed.drive_slope);
}

TEST_F(FingerOnABlob, IsPushedOnlyUpToTheForceLimit) {
  clamp(test::mooneyRivlinScene());
  const double force = equilibriumAt(center(), pushed).force.norm();
  solver_.reset();
  TransitionOptions options;
  const auto reachWith = [&](double largest, const Eigen::Vector3d& target) {
    options.largest_force = largest;
    TransitionSolver solver(problem_, chooseKernels(), options);
    return solver.reach(test::startAtRest(solver), target).outcome;
  };
  EXPECT_TRUE(reachWith(1.5 * force, pushed).converged());
  // The stiffness at rest predicts a larger force than the limit, so no solve is tried.
  const Outcome predicted = reachWith(0.1 * force, pushed);
  EXPECT_EQ(predicted.failure().cause, Cause::beyond_force);
  EXPECT_EQ(predicted.cost.factorizations, 0);
  EXPECT_FALSE(predicted.converged());
}

TEST_F(FingerOnABlob, StartsFromStoredFieldsWithTheirForce) {
  clamp(test::mooneyRivlinScene());
  solver_->chooseTool(0);
  Failure failure;
  const auto there = walk(*solver_, test::startAtRest(*solver_), pushed, 2);
  const auto start = solver_->startFrom(there.outcome.configuration().fields, pushed, failure);
  ASSERT_TRUE(start) << describe(failure);
  EXPECT_LT((start->exerted + there.outcome.equilibrium().force).norm(),
            1e-3 * start->exerted.norm());
}

TEST_F(FingerOnABlob, IsNotPlacedOnFixedNodes) {
  clamp(test::mooneyRivlinScene());
  const Eigen::Vector3d on_the_fixed_side =
      problem_.mesh.nodes[problem_.fixed[problem_.fixed.size() / 2]];
  test::expectBadInput(
      [&] {
        solver_->placeFinger("--at", {on_the_fixed_side, pad_radius});
      },
      {"--at", "contact area", "move it away"});
}

/// A hand that slides and pushes a little between two solves.
TEST_F(FingerOnABlob, IsFollowedToTheEquilibriumThatAWalkFinds) {
  clamp(test::mooneyRivlinScene());
  solver_->chooseTool(0);
  Reached at = walk(*solver_, test::startAtRest(*solver_), pushed, 2);
  ASSERT_TRUE(at.outcome.converged());
  int factorizations = 0;
  Eigen::Vector3d s = center(), p = pushed;
  for (int n = 0; n < 5; ++n) {
    s += Eigen::Vector3d(0, 0.002, 0.001);
    p += Eigen::Vector3d(-0.001, 0.0005, 0);
    at = solver_->follow(*at.end, {s, pad_radius}, p);
    ASSERT_TRUE(at.outcome.converged()) << describe(at.outcome.failure());
    factorizations += at.outcome.cost.factorizations;
  }
  EXPECT_LE(factorizations, 2) << "the factors of a tangent nearby are good enough";
  const Equilibrium followed = at.outcome.equilibrium(), walked = equilibriumAt(s, p);
  EXPECT_LT((followed.force - walked.force).norm(), 1e-4 * walked.force.norm());
  EXPECT_LT((followed.drive - walked.drive).norm(), 1e-3 * walked.drive.norm());
  EXPECT_LT((followed.stiffness - walked.stiffness).norm(), 1e-4 * walked.stiffness.norm());
  EXPECT_NEAR(followed.energy, walked.energy, 1e-6 * walked.energy);
}

TEST_F(FingerOnABlob, IsFollowedInSmallerStepsWhereOneIsTooLarge) {
  clamp(test::mooneyRivlinScene());
  solver_->chooseTool(0);
  const Reached rest = solver_->reach(test::startAtRest(*solver_), Eigen::Vector3d::Zero());
  const Eigen::Vector3d s = center() + Eigen::Vector3d(0, 0.01, 0), p(-0.05, 0.03, 0.02);
  const Reached far = solver_->follow(*rest.end, {s, pad_radius}, p);
  ASSERT_TRUE(far.outcome.converged()) << describe(far.outcome.failure());
  const Equilibrium walked = equilibriumAt(s, p);
  EXPECT_LT((far.outcome.equilibrium().force - walked.force).norm(), 1e-4 * walked.force.norm());
}

TEST_F(FingerOnABlob, IsNotFollowedThroughTheBody) {
  clamp(test::mooneyRivlinScene());
  solver_->chooseTool(0);
  const Reached rest = solver_->reach(test::startAtRest(*solver_), Eigen::Vector3d::Zero());
  const Reached lost = solver_->follow(*rest.end, {center(), pad_radius}, {-0.5, 0, 0});
  EXPECT_FALSE(lost.outcome.converged());
  // After a failure, the next follow() may start from the place of the hand before it.
  EXPECT_TRUE(solver_->follow(*rest.end, {center(), pad_radius}, pushed).outcome.converged());
}

}  // namespace
}  // namespace palpate
