#include "viewer/report/error_measures.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

constexpr double tolerance = 1e-14;

ForceComparison comparison(const Eigen::Vector3d& exact, const Eigen::Vector3d& interpolated,
                           double bound = std::nan(""), bool covered = true) {
  return {exact, interpolated, bound, covered};
}

TEST(ErrorMeasures, FollowThePapersEquations) {
  const std::vector<ForceComparison> points = {comparison({1, -2, 2}, {1.1, -2, 2}),
                                               comparison({0.5, 0.1, -0.2}, {0.5, 0.4, -0.6})};
  const ErrorMeasures measures = measureErrors(points, {});
  EXPECT_EQ(measures.count, 2U);
  EXPECT_NEAR(measures.mean_component, (0.1 + 0.3 + 0.4) / 6, tolerance);
  EXPECT_NEAR(measures.mean_relative_component, (0.1 / 1 + 0.3 / 0.1 + 0.4 / 0.2) / 6, tolerance);
  EXPECT_NEAR(measures.error.mean, (0.1 + 0.5) / 2, tolerance);
  EXPECT_NEAR(measures.error.rms, std::sqrt((0.01 + 0.25) / 2), tolerance);
  EXPECT_NEAR(measures.error.maximum, 0.5, tolerance);
  EXPECT_NEAR(measures.relative.maximum, 0.5 / std::sqrt(0.3), tolerance);
  EXPECT_NEAR(measures.relative_to_mean_force, 0.6 / (3 + std::sqrt(0.3)), tolerance);
}

TEST(ErrorMeasures, DoNotDivideByVanishingForces) {
  const ErrorMeasures measures = measureErrors(
      std::vector{comparison({0, 0, 0}, {0.01, 0, 0}), comparison({1, 0, 0}, {1, 0, 0})}, {});
  EXPECT_NEAR(measures.mean_relative_component, 0.01 / relative_error_floor / 6, tolerance);
  EXPECT_NEAR(measures.relative.maximum, 0.01 / relative_error_floor, tolerance);
  const ErrorMeasures zero = measureErrors(std::vector{comparison({0, 0, 0}, {0, 0, 0})}, {});
  EXPECT_EQ(zero.error.maximum, 0);
  EXPECT_TRUE(std::isnan(zero.relative_to_mean_force));
}

TEST(ErrorMeasures, CountErrorsWithinTheTarget) {
  const std::vector<ForceComparison> points = {
      comparison({10, 0, 0}, {10.29, 0, 0}), comparison({10, 0, 0}, {10.31, 0, 0}),
      comparison({0.1, 0, 0}, {0.109, 0, 0}), comparison({0.1, 0, 0}, {0.111, 0, 0})};
  EXPECT_EQ(measureErrors(points, {.force_error = 0.03, .force_floor = 0.01}).within_target, 0.5);
  EXPECT_EQ(measureErrors(points, {.force_error = 0.04, .force_floor = 0.01}).within_target, 0.75);
}

TEST(ErrorMeasures, JudgeBoundsOnlyWhereTheyExist) {
  const std::vector<ForceComparison> points = {
      comparison({1, 0, 0}, {1.1, 0, 0}, 0.3), comparison({1, 0, 0}, {1.1, 0, 0}, 0.05),
      comparison({1, 0, 0}, {1, 0, 0}, 0.0), comparison({1, 0, 0}, {5, 0, 0})};
  const ErrorMeasures measures = measureErrors(points, {});
  EXPECT_EQ(measures.bounds, 3U);
  EXPECT_NEAR(measures.bound_holds, 2.0 / 3, tolerance);
  EXPECT_NEAR(measures.bound_over_error.median, (3 + 0.5) / 2, 1e-12);
}

TEST(ErrorMeasures, TellCoveredPointsFromTheWholeBall) {
  const std::vector<ForceComparison> points = {
      comparison({1, 0, 0}, {1.1, 0, 0}), comparison({1, 0, 0}, {3, 0, 0}, std::nan(""), false)};
  EXPECT_EQ(measureErrors(points, {}).covered, 0.5);
  const ErrorMeasures covered = measureCoveredErrors(points, {});
  EXPECT_EQ(covered.count, 1U);
  EXPECT_NEAR(covered.error.maximum, 0.1, tolerance);
}

TEST(ErrorMeasures, AreNaNWithoutData) {
  const ErrorMeasures measures = measureErrors({}, {});
  EXPECT_EQ(measures.count, 0U);
  for (const double value : {measures.error.mean, measures.error.maximum, measures.mean_component,
                             measures.within_target, measures.bound_holds, measures.covered})
    EXPECT_TRUE(std::isnan(value));
}

TEST(ErrorMeasures, PercentilesLieBetweenOrderStatistics) {
  const std::vector<double> sorted = {1, 2, 4, 8, 16};
  EXPECT_EQ(percentile(sorted, 0), 1);
  EXPECT_EQ(percentile(sorted, 0.5), 4);
  EXPECT_NEAR(percentile(sorted, 0.95), 8 + 0.8 * 8, tolerance * 16);
  EXPECT_EQ(percentile(sorted, 1), 16);
  EXPECT_EQ(percentile(std::vector{3.0}, 0.99), 3);
}

ForceComparison at(double distance, const Eigen::Vector3d& exact,
                   const Eigen::Vector3d& interpolated) {
  return {.exact = exact, .interpolated = interpolated, .distance = distance};
}

TEST(ErrorShells, MeasureTheExactSolutionsInEachShell) {
  const std::vector<ErrorShell> shells =
      measureShells({{at(0.01, {0, 0, 1}, {0, 0, 1.5}), at(0.02, {0, 0, 2}, {0, 0, 3}),
                      at(0.08, {0, 0, 1}, {0, 0, 1})},
                     {}},
                    0.08, {});
  ASSERT_EQ(shells.size(), shell_count);
  EXPECT_EQ(shells[0].methods[0].count, 0U);
  // A solution on the border of two shells belongs to the outer one.
  EXPECT_EQ(shells[1].methods[0].count, 1U);
  EXPECT_NEAR(shells[1].from, 0.01, 1e-15);
  EXPECT_NEAR(shells[1].methods[0].error.mean, 0.5, 1e-15);
  EXPECT_NEAR(shells[2].methods[0].relative.maximum, 0.5, 1e-15);
  // A solution on the sphere belongs to the last shell.
  EXPECT_EQ(shells.back().methods[0].count, 1U);
  EXPECT_NEAR(shells.back().to, 0.08, 1e-15);
  for (const ErrorShell& shell : shells) EXPECT_EQ(shell.methods[1].count, 0U);
}

TEST(ErrorShells, HaveTheMeanAndTheMaximumOfEqs13And14) {
  const std::vector<ErrorShell> shells = measureShells(
      {{at(0.01, {3, 4, 0}, {3, 4.5, 0}), at(0.01, {0, 0.5, 0}, {0.1, 0.5, 0})}}, 1, {});
  const ErrorMeasures& measures = shells[0].methods[0];
  EXPECT_NEAR(measures.error.mean, (0.5 + 0.1) / 2, 1e-15);
  EXPECT_NEAR(measures.error.maximum, 0.5, 1e-15);
  EXPECT_NEAR(measures.relative.mean, (0.5 / 5 + 0.1 / 0.5) / 2, 1e-15);
  EXPECT_NEAR(measures.relative.maximum, 0.2, 1e-15);
  // The two errors have six components, and the relative error of a zero component is relative to
  // the floor.
  EXPECT_NEAR(measures.mean_component, (0.5 + 0.1) / 6, 1e-15);
  EXPECT_NEAR(measures.max_component, 0.5, 1e-15);
  EXPECT_NEAR(measures.mean_relative_component, (0.5 / 4 + 0.1 / relative_error_floor) / 6, 1e-15);
  EXPECT_NEAR(measures.max_relative_component, 0.1 / relative_error_floor, 1e-15);
}

}  // namespace
}  // namespace palpate
