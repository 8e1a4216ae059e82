#include "scheduler/plan/space_plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

#include "common/interpolation/branch_check.hpp"
#include "tests/scheduler/build_world.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/same_records.hpp"
#include "tests/support/sample_dataset.hpp"

namespace palpate {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// A worker's answer to a transition, a pure function.
using Solver = std::function<Outcome(const SpacePlan&, const Transition&)>;

Outcome equilibriumOf(const test::AnalyticEnergy& energy, const Eigen::Vector3d& p) {
  Configuration found;
  found.equilibrium.force = -energy.gradient(p);
  found.equilibrium.stiffness = -energy.hessian(p);
  found.equilibrium.energy = energy.energy(p);
  return {found, {}};
}

Outcome smooth(const SpacePlan& plan, const Transition& transition) {
  return equilibriumOf(test::StiffeningEnergy(), plan.positions().displacement(transition.target));
}

Outcome failed(double step_reached = 0.5, Cause cause = Cause::step_budget) {
  return {Failure{.cause = cause, .step_reached = step_reached}, {}};
}

/// Records everything that a plan requests, in random order if `random` is given.
void finish(SpacePlan& plan, const Solver& solver, std::mt19937* random = nullptr) {
  std::vector<Transition> ready = plan.takeReady();
  while (!ready.empty()) {
    const std::size_t n = random == nullptr ? 0 : (*random)() % ready.size();
    const Transition transition = ready[n];
    ready.erase(ready.begin() + static_cast<std::ptrdiff_t>(n));
    const Outcome outcome = solver(plan, transition);
    const double energy = outcome.converged() ? outcome.equilibrium().energy : 0;
    plan.record(transition, outcome, ContentId::of(std::to_string(energy)));
    for (const Transition& next : plan.takeReady()) ready.push_back(next);
  }
  EXPECT_TRUE(plan.complete());
}

struct SpacePlanTest : testing::Test {
  Problem problem = test::cubeProblem();

  SpacePlanTest() {
    problem.scene.workspace = {0.04, 0.02, 1e6, true};
    problem.scene.accuracy = {};
  }
  SpaceTable finished(const Solver& solver, std::mt19937* random = nullptr) {
    SpacePlan plan(problem, 0);
    finish(plan, solver, random);
    return plan.table();
  }
};

TEST_F(SpacePlanTest, FindsItsTransitionsByTheirPoints) {
  SpacePlan plan(problem, 0);
  finish(plan, smooth);
  const Transition transition{plan.size() - 1, 0};
  const ResultKey key = plan.keyOf(transition);
  EXPECT_EQ(plan.find(key), transition);
  EXPECT_FALSE(plan.find({0, {1000000, 0, 0}, key.parent})) << "it has no such point";
  EXPECT_EQ(findIn({plan}, key), transition);
  EXPECT_FALSE(findIn({plan}, {1, key.target, key.parent})) << "there is no such space";
}

TEST_F(SpacePlanTest, AUniformSceneHasOnlyItsLattice) {
  const SpaceTable table = finished(smooth);
  EXPECT_EQ(table.points.size(), 33u);
  EXPECT_EQ(table.lattice.divisions(), 1);
  EXPECT_THAT(table.splits, IsEmpty());
  EXPECT_THAT(table.probes, IsEmpty());
  for (const PointRecord& point : table.points) EXPECT_EQ(point.tag, Tag::expandable);
}

TEST_F(SpacePlanTest, ProbesAreNotLatticePointsAndSolvedFromTheNearest) {
  problem.scene.accuracy.probes = 50;
  const SpaceTable table = finished(smooth);
  EXPECT_EQ(table.points.size(), 33u);
  EXPECT_EQ(table.lattice.size(), 33);
  ASSERT_EQ(table.probes.size(), 50u);
  for (const Probe& probe : table.probes) {
    EXPECT_LE(probe.displacement.norm(), 0.04);
    EXPECT_EQ(probe.record.tag, Tag::expandable);
    EXPECT_LE((table.lattice.displacement(probe.record.parent) - probe.displacement).norm(), 0.02);
    EXPECT_EQ(probe.record.equilibrium.energy, test::StiffeningEnergy().energy(probe.displacement));
  }
}

TEST_F(SpacePlanTest, AProbeThatCannotBeSolvedSaysWhy) {
  problem.scene.accuracy.probes = 3;
  const SpaceTable table = finished([](const SpacePlan& plan, const Transition& transition) {
    return transition.target < 33 ? smooth(plan, transition) : failed();
  });
  ASSERT_EQ(table.probes.size(), 3u);
  for (const Probe& probe : table.probes) {
    EXPECT_EQ(probe.record.tag, Tag::failed);
    EXPECT_EQ(probe.record.cause, Cause::step_budget);
  }
  EXPECT_THAT(table.attempts, IsEmpty()) << "probes are not counted as points";
}

TEST_F(SpacePlanTest, ProbesFillTheBallEvenlyAndNeverLieOnAPlaneOfCells) {
  const Lattice lattice(0.1, 0.02, lattice_divisions);
  const std::vector<LatticePoint> positions = probePositions(lattice, 2000);
  ASSERT_EQ(positions.size(), 2000u);
  int upper = 0, inner = 0;
  for (const LatticePoint& position : positions) {
    for (const std::int32_t coordinate : position) EXPECT_NE(coordinate % 2, 0);
    const double distance = lattice.displacementOf(position).norm();
    EXPECT_LE(distance, 0.1);
    upper += position[2] > 0 ? 1 : 0;
    inner += distance < 0.05 ? 1 : 0;
  }
  EXPECT_NEAR(upper, 1000, 20);
  EXPECT_NEAR(inner, 250, 20) << "an eighth of the volume";
}

/// Point `target` ends on a branch of higher energy if reached from its first parent.
Solver withJumpAt(const LatticePoint& target) {
  auto first = std::make_shared<std::int32_t>(-1);
  return [target, first](const SpacePlan& plan, const Transition& transition) {
    Outcome outcome = smooth(plan, transition);
    if (plan.positions().point(transition.target) != target) return outcome;
    if (*first < 0) *first = transition.parent;
    if (transition.parent == *first) {
      outcome.configuration().equilibrium.energy += 1;
      outcome.configuration().equilibrium.force += Eigen::Vector3d(20, -30, 10);
    }
    return outcome;
  };
}

TEST_F(SpacePlanTest, APointOnAnotherBranchIsSolvedFromItsNeighboursAndTheLeastEnergyIsKept) {
  const LatticePoint odd = {0, 1, 1};
  SpacePlan plan(problem, 0);
  const std::int32_t number = *plan.positions().indexOf(odd);
  bool in_steps = false;
  finish(plan, [&, solve = withJumpAt(odd)](const SpacePlan& at, const Transition& transition) {
    if (at.stage() == Stage::branches) in_steps = at.stepsOf(transition) == steps_of_retry;
    return solve(at, transition);
  });
  EXPECT_TRUE(in_steps);
  EXPECT_EQ(plan.points().record(number).equilibrium.energy,
            test::StiffeningEnergy().energy(plan.positions().displacement(number)));
  EXPECT_THAT(inconsistentEdges(plan.table()), IsEmpty());
}

TEST_F(SpacePlanTest, AStageBeginsWhenTheLastOpenPointIsRecorded) {
  SpacePlan plan(problem, 0);
  int begun = 0, were_open = plan.openCount();
  std::vector<Stage> stages = {plan.stage()};
  finish(plan, [&, solve = withJumpAt({0, 1, 1})](const SpacePlan& at, const Transition& asked) {
    if (at.stagesBegun() != begun) {
      EXPECT_EQ(were_open, 1);
      stages.push_back(at.stage());
    }
    begun = at.stagesBegun();
    were_open = at.openCount();
    return solve(at, asked);
  });
  EXPECT_THAT(stages, ElementsAre(Stage::lattice, Stage::branches));
  EXPECT_GT(plan.stagesBegun(), begun);
}

TEST_F(SpacePlanTest, AJumpFoundFromEveryParentStays) {
  const LatticePoint odd = {0, 1, 1};
  const SpaceTable table = finished([&](const SpacePlan& plan, const Transition& transition) {
    Outcome outcome = smooth(plan, transition);
    if (plan.positions().point(transition.target) == odd)
      outcome.configuration().equilibrium.force += Eigen::Vector3d(20, -30, 10);
    return outcome;
  });
  EXPECT_FALSE(inconsistentEdges(table).empty());
}

/// A narrow bump in the energy that coarse cells cannot resolve.
class BumpyEnergy : public test::AnalyticEnergy {
 public:
  double energy(const Eigen::Vector3d& p) const override {
    return base_.energy(p) + height * std::exp(-squaredDistance(p));
  }
  Eigen::Vector3d gradient(const Eigen::Vector3d& p) const override {
    return base_.gradient(p) -
           2 / (width * width) * height * std::exp(-squaredDistance(p)) * (p - center());
  }
  Eigen::Matrix3d hessian(const Eigen::Vector3d& p) const override {
    const double factor = height * std::exp(-squaredDistance(p)), w2 = width * width;
    const Eigen::Vector3d d = p - center();
    return base_.hessian(p) +
           factor * (4 / (w2 * w2) * d * d.transpose() - 2 / w2 * Eigen::Matrix3d::Identity());
  }

 private:
  static constexpr double height = 0.02, width = 0.012;
  static Eigen::Vector3d center() { return {0.015, 0.01, 0.005}; }
  static double squaredDistance(const Eigen::Vector3d& p) {
    return (p - center()).squaredNorm() / (width * width);
  }
  test::StiffeningEnergy base_;
};

Outcome bumpy(const SpacePlan& plan, const Transition& transition) {
  // The solve fails from some parents, so that attempts matter too.
  if ((transition.target * 31 + transition.parent * 17) % 11 == 0 && transition.target != 0)
    return failed();
  return equilibriumOf(BumpyEnergy(), plan.positions().displacement(transition.target));
}

TEST_F(SpacePlanTest, AnAdaptiveSceneRefinesOnlyWhereTheErrorIsLarge) {
  problem.scene.accuracy = {.force_error = 0.03, .force_floor = 0.01, .levels = 2, .probes = 5};
  const SpaceTable table = finished(bumpy);
  EXPECT_GT(table.points.size(), 33u);
  ASSERT_FALSE(table.splits.empty());
  EXPECT_TRUE(
      std::is_sorted(table.splits.begin(), table.splits.end(), [](const auto& a, const auto& b) {
        return std::tie(a.level, a.lowest) < std::tie(b.level, b.lowest);
      }));
  EXPECT_LT(table.points.size(), 2000u) << "the ball at the finest level has more";
  EXPECT_EQ(table.probes.size(), 5u);
}

TEST_F(SpacePlanTest, TheOrderInWhichResultsArriveChangesNothing) {
  problem.scene.accuracy = {.force_error = 0.03, .force_floor = 0.01, .levels = 2, .probes = 5};
  const SpaceTable table = finished(bumpy);
  for (const unsigned seed : {1u, 2u, 3u}) {
    std::mt19937 random(seed);
    test::expectSame(table, finished(bumpy, &random));
  }
}

TEST_F(SpacePlanTest, AnOriginThatCannotBeSolvedEndsThePlan) {
  problem.scene.accuracy = {.force_error = 0.03, .force_floor = 0.01, .levels = 2, .probes = 5};
  const SpaceTable table = finished([](const SpacePlan&, const Transition&) { return failed(); });
  for (const PointRecord& point : table.points) EXPECT_EQ(point.tag, Tag::failed);
  for (const Probe& probe : table.probes) EXPECT_EQ(probe.record.cause, Cause::unreachable);
}

TEST_F(SpacePlanTest, AFailedPointHasTheCauseOfTheAttemptThatGotFurthest) {
  const LatticePoint hole = {1, 1, 0};
  const SpaceTable table = finished([&](const SpacePlan& plan, const Transition& transition) {
    if (plan.positions().point(transition.target) != hole) return smooth(plan, transition);
    return transition.parent == 0 ? failed(0.9, Cause::wrong_inertia) : failed(0.4);
  });
  const PointRecord& point = table.points[*table.lattice.indexOf(hole)];
  EXPECT_EQ(point.tag, Tag::failed);
  EXPECT_EQ(point.cause, Cause::wrong_inertia);
}

TEST_F(SpacePlanTest, AFingersPointIsGivenUpAfterFewerParentsThanANodes) {
  const LatticePoint hole = {1, 1, 0};
  const auto all_but_the_hole = [&](const SpacePlan& plan, const Transition& transition) {
    return plan.positions().point(transition.target) == hole ? failed() : smooth(plan, transition);
  };
  const std::size_t of_a_node = finished(all_but_the_hole).attempts.size();
  problem.active[0].finger = Finger{Eigen::Vector3d::Zero(), 0.02};
  EXPECT_EQ(finished(all_but_the_hole).attempts.size(), 3u);
  EXPECT_EQ(of_a_node, 8u);
}

/// The plan of a probe place.
struct ProbePlacePlan : SpacePlanTest {
  ProbePlacePlan() {
    problem.scene.accuracy = {.force_error = 0.03, .probes = 7};
    problem.active[0].finger = Finger{Eigen::Vector3d::Zero(), 0.02};
    problem.active[0].probe = problem.scene.active[0].probe = probe;
  }
  const Eigen::Vector3d probe = {0.011, -0.02, 0.025};
};

TEST_F(ProbePlacePlan, IsTheRestPositionAndOneProbeInHalfSpacingSteps) {
  std::vector<std::int32_t> steps;
  const SpaceTable table =
      finished([&](const SpacePlan& plan, const Transition& transition) -> Outcome {
        steps.push_back(plan.stepsOf(transition));
        return smooth(plan, transition);
      });
  EXPECT_THAT(steps, testing::ElementsAre(1, 4));  // 34 mm
  EXPECT_EQ(table.points.size(), 1u);
  ASSERT_EQ(table.probes.size(), 1u);
  EXPECT_EQ(table.probes[0].record.tag, Tag::expandable);
  EXPECT_EQ(table.probes[0].record.parent, 0);
  EXPECT_LT((table.probes[0].displacement - probe).norm(), 0.02 / lattice_divisions * 2);
  EXPECT_LE(table.probes[0].displacement.norm(), probe.norm());
  EXPECT_EQ(faultOf(table), "");
}

TEST_F(ProbePlacePlan, SaysWhyItsProbeCouldNotBeSolved) {
  const SpaceTable table = finished([&](const SpacePlan& plan, const Transition& transition) {
    return transition.target == 0 ? smooth(plan, transition) : failed();
  });
  EXPECT_EQ(table.probes.at(0).record.cause, Cause::step_budget);
  const SpaceTable without_rest =
      finished([](const SpacePlan&, const Transition&) { return failed(); });
  EXPECT_EQ(without_rest.probes.at(0).record.cause, Cause::unreachable);
}

TEST_F(SpacePlanTest, RefusesUnrequestedResults) {
  SpacePlan plan(problem, 0);
  test::expectError(ExitCode::failed,
                    [&] {
                      plan.record({5, 1}, failed(), {});
                    },
                    {"point 5", "not requested"});
}

}  // namespace
}  // namespace palpate
