#include "viewer/report/error_measures.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

double meanOf(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / values.size();
}

void measureBounds(std::span<const ForceComparison> comparisons, ErrorMeasures& measures) {
  std::size_t holds = 0;
  std::vector<double> ratios;
  for (const ForceComparison& at : comparisons) {
    // Methods without bounds give NaN.
    if (!std::isfinite(at.error_bound)) continue;
    const double error = (at.interpolated - at.exact).norm();
    ++measures.bounds;
    holds += error <= at.error_bound;
    // If the error is zero, the ratio of the bound to the error is undefined.
    if (error > 0) ratios.push_back(at.error_bound / error);
  }
  if (measures.bounds > 0) measures.bound_holds = static_cast<double>(holds) / measures.bounds;
  measures.bound_over_error = spreadOf(std::move(ratios));
}

}  // namespace

double percentile(std::span<const double> sorted, double share) {
  PALPATE_ASSERT(!sorted.empty(), "a percentile needs values");
  const double place = share * (sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  if (below + 1 >= sorted.size()) return sorted.back();
  return std::lerp(sorted[below], sorted[below + 1], place - below);
}

Spread spreadOf(std::vector<double> values) {
  if (values.empty()) return {};
  std::ranges::sort(values);
  const double squares = std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
  return {.mean = meanOf(values),
          .rms = std::sqrt(squares / values.size()),
          .median = percentile(values, 0.5),
          .percentile_95 = percentile(values, 0.95),
          .percentile_99 = percentile(values, 0.99),
          .maximum = values.back()};
}

ErrorMeasures measureErrors(std::span<const ForceComparison> comparisons,
                            const AccuracyTarget& target) {
  ErrorMeasures measures;
  measures.count = comparisons.size();
  if (comparisons.empty()) return measures;
  std::vector<double> errors, relative, components, relative_components;
  double forces = 0;
  std::size_t allowed = 0, covered = 0;
  for (const ForceComparison& at : comparisons) {
    const Eigen::Vector3d difference = at.interpolated - at.exact;
    const double error = difference.norm(), force = at.exact.norm();
    errors.push_back(error);
    relative.push_back(error / std::max(force, relative_error_floor));
    for (int i = 0; i < 3; ++i) {
      components.push_back(std::abs(difference[i]));
      relative_components.push_back(std::abs(difference[i]) /
                                    std::max(std::abs(at.exact[i]), relative_error_floor));
    }
    forces += force;
    allowed += error <= std::max(target.force_error * force, target.force_floor);
    covered += at.covered;
  }
  const double count = comparisons.size();
  measures.mean_component = meanOf(components);
  measures.max_component = std::ranges::max(components);
  measures.mean_relative_component = meanOf(relative_components);
  measures.max_relative_component = std::ranges::max(relative_components);
  if (forces > 0) measures.relative_to_mean_force = count * meanOf(errors) / forces;
  measures.error = spreadOf(std::move(errors));
  measures.relative = spreadOf(std::move(relative));
  measures.within_target = allowed / count;
  measures.covered = covered / count;
  measureBounds(comparisons, measures);
  return measures;
}

ErrorMeasures measureCoveredErrors(std::span<const ForceComparison> comparisons,
                                   const AccuracyTarget& target) {
  // Copy them, because measureErrors() needs contiguous memory.
  std::vector<ForceComparison> covered;
  std::ranges::copy_if(comparisons, std::back_inserter(covered), &ForceComparison::covered);
  return measureErrors(covered, target);
}

std::vector<ErrorShell> measureShells(const std::vector<std::vector<ForceComparison>>& methods,
                                      double radius, const AccuracyTarget& target) {
  std::vector<ErrorShell> shells;
  const auto edge = [&](std::size_t s) { return radius * static_cast<double>(s) / shell_count; };
  for (std::size_t s = 0; s < shell_count; ++s) shells.push_back({edge(s), edge(s + 1), {}});
  for (const std::vector<ForceComparison>& method : methods) {
    std::vector<std::vector<ForceComparison>> in_shell(shell_count);
    for (const ForceComparison& at : method) {
      // A point on the sphere, or outside of it by rounding, belongs to the last shell.
      const auto shell = static_cast<std::size_t>(shell_count * at.distance / radius);
      in_shell[std::min(shell, shell_count - 1)].push_back(at);
    }
    for (std::size_t s = 0; s < shell_count; ++s)
      shells[s].methods.push_back(measureErrors(in_shell[s], target));
  }
  return shells;
}

}  // namespace palpate
