#include "scheduler/plan/forecast.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/scheduler/build_world.hpp"
#include "tests/support/sample_dataset.hpp"

namespace palpate {
namespace {

/// Returns whether the force at a displacement (m) is below the device's limit.
using IsSoft = std::function<bool(const Eigen::Vector3d&)>;

struct ForecastTest : testing::Test {
  /// Progress of a build of one space at some moment.
  struct Moment {
    double forecast = 0;
    int results = 0;
  };
  Problem problem = test::cubeProblem();

  /// Completes one space, first come, first served.
  std::vector<Moment> build(const IsSoft& is_soft) {
    std::vector<Moment> moments;
    std::vector<SpacePlan> plans;
    plans.emplace_back(problem, 0);
    SpacePlan& plan = plans.front();
    std::vector<Transition> ready = plan.takeReady();
    for (std::size_t n = 0; n < ready.size(); ++n) {
      const Forecast forecast = forecastOf(problem, plans);
      moments.push_back({forecast.ready + forecast.expected, static_cast<int>(n)});
      const Transition transition = ready[n];
      plan.record(transition, outcomeAt(plan.positions().displacement(transition.target), is_soft),
                  ContentId::of(std::to_string(n)));
      for (const Transition& next : plan.takeReady()) ready.push_back(next);
    }
    EXPECT_TRUE(plan.complete());
    const Forecast nothing = forecastOf(problem, plans);
    EXPECT_EQ(nothing.ready + nothing.expected, 0);
    return moments;
  }
  static Outcome outcomeAt(const Eigen::Vector3d& p, const IsSoft& is_soft) {
    const test::StiffeningEnergy energy;
    Configuration found;
    found.equilibrium.force =
        is_soft(p) ? Eigen::Vector3d(-energy.gradient(p)) : Eigen::Vector3d::Constant(1e9);
    found.equilibrium.stiffness = -energy.hessian(p);
    found.equilibrium.energy = energy.energy(p);
    return {found, {}};
  }
  /// Checks the forecasts from the time when this share of the build is done until a twentieth is
  /// left.
  static void expectHonest(const std::vector<Moment>& moments, double from = 0.1,
                           double factor = 1.5) {
    const double all = std::ssize(moments);
    for (const Moment& moment : moments) {
      if (moment.results < from * all || moment.results > 0.95 * all) continue;
      const double ratio = moment.forecast / (all - moment.results);
      EXPECT_GT(ratio, 1 / factor) << moment.results << " of " << all;
      EXPECT_LT(ratio, factor) << moment.results << " of " << all;
    }
  }
};

TEST_F(ForecastTest, CountsAllPointsOfAFullyReachedLattice) {
  problem.scene.workspace.radius = 0.06;
  problem.scene.workspace.max_force = 1e6;
  const auto moments = build([](const Eigen::Vector3d&) { return true; });
  expectHonest(moments);
  EXPECT_NEAR(moments.back().forecast, 1, 1e-9);
}

/// Regression: unknown points that no transition can reach were counted as remaining work; near the
/// end they were all of it.
TEST_F(ForecastTest, LeavesOutPointsBehindTerminatingOnes) {
  problem.scene.workspace.radius = 0.06;
  problem.scene.workspace.max_force = 1e6;
  expectHonest(build([](const Eigen::Vector3d& p) { return p.x() < 0.015; }));
}

TEST_F(ForecastTest, CountsThePointsThatRefinedCellsNeed) {
  problem.scene.workspace.radius = 0.06;
  problem.scene.workspace.spacing = 0.03;
  problem.scene.workspace.max_force = 1e6;
  problem.scene.accuracy = {.force_error = 0.003, .force_floor = 1e-3, .levels = 3};
  const auto moments = build([](const Eigen::Vector3d&) { return true; });
  EXPECT_GT(moments.size(), 150u) << "rounds of refinement";
  expectHonest(moments, 0.2, 2);
}

TEST_F(ForecastTest, CountsProbesBeforeTheyExist) {
  problem.scene.workspace.radius = 0.04;
  problem.scene.workspace.max_force = 1e6;
  problem.scene.accuracy.probes = 100;
  expectHonest(build([](const Eigen::Vector3d&) { return true; }));
}

}  // namespace
}  // namespace palpate
