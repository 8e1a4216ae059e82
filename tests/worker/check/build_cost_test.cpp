#include "worker/check/build_cost.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "tests/support/meshes.hpp"
#include "tests/support/problems.hpp"

namespace palpate {
namespace {

/// A cube of 27 nodes, touched at one place. The lattice has a radius of two spacings: the origin
/// and 6 points within one spacing, 26 beyond.
class BuildCosts : public ::testing::Test {
 protected:
  BuildCosts() {
    scene.workspace.radius = 0.04;
    scene.workspace.spacing = 0.02;
  }
  BuildCost cost(const std::vector<Path>& paths) {
    problem = test::clampedProblem(scene, test::cubeMesh(0.1, 2), {0.1, 0.05, 0.05}, 0.06);
    MeasuredPaths measured;
    measured.paths = paths;
    return buildCost(problem, measured);
  }
  static Path path(std::vector<PathStep> steps, PathEnd end = PathEnd::rim) {
    return {std::move(steps), end};
  }

  Scene scene = test::mooneyRivlinScene();
  Problem problem;
};

TEST_F(BuildCosts, WeightTrialSolvesByThePointsAtTheirDistance) {
  const double one = cost({path({{1, true}, {1, true}})}).least.seconds;
  EXPECT_EQ(problem.active.size(), 1u);
  EXPECT_NEAR(cost({path({{1, true}, {11, true}})}).least.seconds - one, one * 10 * 26 / 33, 1e-9);
  EXPECT_NEAR(cost({path({{2, true}, {2, true}}), path({{4, true}, {4, true}})}).least.seconds,
              3 * one, 1e-9);
}

TEST_F(BuildCosts, CountNothingBeyondTheEndOfTheTrialSolves) {
  const BuildCost all = cost({path({{1, true}, {1, true}})});
  EXPECT_EQ(all.reached, 1);
  EXPECT_DOUBLE_EQ(all.usual_reach, 0.04);
  const BuildCost half =
      cost({path({{1, true}, {1, true}}), path({{1, true}}, PathEnd::max_force)});
  EXPECT_NEAR(half.reached, (7 + 13) / 33.0, 1e-12);
  EXPECT_NEAR(half.least.seconds, all.least.seconds * (7 + 13) / 33, 1e-9);
  const BuildCost none =
      cost({path({{1, true}}, PathEnd::max_force), path({{1, true}}, PathEnd::max_force)});
  EXPECT_DOUBLE_EQ(none.usual_reach, 0.02);
}

TEST_F(BuildCosts, AreZeroIfNoTrialSolveSucceeds) {
  const Path nowhere = path({{1, false}}, PathEnd::failed);
  EXPECT_NEAR(cost({nowhere, nowhere, nowhere}).reached, 0, 1e-12);
}

TEST_F(BuildCosts, CountFailuresAsDearerAndNotAsTheEnd) {
  const BuildCost solved = cost({path({{1, true}, {1, true}})});
  const BuildCost failed =
      cost({path({{1, true}, {1, false}}, PathEnd::failed), path({{1, true}, {1, true}})});
  EXPECT_NEAR(failed.least.seconds, solved.least.seconds * (7 + 1.5 * 26) / 33, 1e-9);
  EXPECT_NEAR(failed.reached, (7 + 26 * 0.625) / 33.0, 1e-12)
      << "half of the failing points have a solved neighbour, and half of these are solved";
}

TEST_F(BuildCosts, ExtrapolateBeyondTrialSolvesThatWereCut) {
  const BuildCost all = cost({path({{1, true}, {1, true}})});
  const BuildCost cut = cost({path({{1, true}}, PathEnd::cut)});
  EXPECT_EQ(cut.least.seconds, all.least.seconds);
  EXPECT_EQ(cut.reached, 1);
}

TEST_F(BuildCosts, OfAdaptiveBuildsGrowWithTheErrorOfTheTrialSolves) {
  const BuildCost uniform = cost({path({{1, true, 9}, {1, true, 9}})});
  EXPECT_EQ(uniform.likely.configurations, uniform.least.configurations);
  scene.accuracy = {.force_error = 0.03, .levels = 2, .probes = 10};
  const auto likely = [&](double error) {
    return cost({path({{1, true, error}, {1, true, error}})}).likely.configurations;
  };
  EXPECT_EQ(cost({path({{1, true, 0.01}, {1, true, 0.01}})}).least.configurations, 33 + 10);
  EXPECT_EQ(likely(0.01), 33 + 10);
  EXPECT_EQ(likely(1), 33 * 8 + 10) << "split once, a point is eight";
  EXPECT_EQ(likely(100), 33 * (8 + 4 * 7) + 10) << "no more often than levels allow";
}

TEST_F(BuildCosts, OfAdaptiveBuildsIncludeTheCellsWhereAnswersEnd) {
  scene.accuracy = {.force_error = 0.03, .levels = 2};
  const Path whole = path({{1, true}, {1, true}}),
             cut_off = path({{1, true}, {1, false}}, PathEnd::failed);
  EXPECT_EQ(cost({whole, cut_off}).likely.configurations, 33 + 26 * (7 + 4 * 7) / 2)
      << "half of the cells of the second shell";
}

/// With real solves.
TEST_F(BuildCosts, AreMeasuredWithTheErrorAtHalfSteps) {
  scene.accuracy = {.force_error = 0.03, .force_floor = 1e-9, .levels = 2};
  cost({});
  const MeasuredPaths paths = measurePaths(problem, {.seconds = 60, .transitions = 2});
  scene.workspace.spacing = 0.01;
  cost({});
  const MeasuredPaths finer = measurePaths(problem, {.seconds = 60, .transitions = 2});
  EXPECT_GT(paths.paths[0].steps[0].error, 4 * finer.paths[0].steps[0].error)
      << "the same path in half the steps";
  EXPECT_GT(finer.paths[0].steps[0].error, 0);
}

TEST_F(BuildCosts, AreEmptyWithoutATrialSolve) {
  EXPECT_EQ(cost({}).least.seconds, 0);
  EXPECT_EQ(cost({}).reached, 0);
}

/// With real solves.
TEST_F(BuildCosts, AreMeasuredWithinTheirLimits) {
  scene.workspace.max_force = 1000;
  cost({});
  const MeasuredPaths few = measurePaths(problem, {.seconds = 60, .transitions = 5});
  EXPECT_EQ(few.transitions, 5);
  EXPECT_EQ(few.paths.back().end, PathEnd::cut);
  for (const Path& path : few.paths)
    for (const PathStep& step : path.steps) EXPECT_GT(step.seconds, 0);
  EXPECT_EQ(measurePaths(problem, {.seconds = 0}).transitions, 1);
}

TEST_F(BuildCosts, AreMeasuredOnlyUpToTheForceLimit) {
  scene.workspace.max_force = 1e-3;
  cost({});
  const MeasuredPaths paths = measurePaths(problem, {.seconds = 60, .transitions = 5});
  EXPECT_EQ(paths.paths.size(), 5u);
  for (const Path& path : paths.paths) EXPECT_EQ(path.end, PathEnd::max_force);
}

}  // namespace
}  // namespace palpate
