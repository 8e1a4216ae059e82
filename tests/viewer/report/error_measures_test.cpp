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

}  // namespace
}  // namespace palpate
