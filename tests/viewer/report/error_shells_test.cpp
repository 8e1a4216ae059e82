#include "viewer/report/error_measures.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

DistanceComparison at(double distance, const Eigen::Vector3d& exact,
                      const Eigen::Vector3d& interpolated) {
  return {distance, {.exact = exact, .interpolated = interpolated}};
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
