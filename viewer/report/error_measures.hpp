#pragma once

#include <Eigen/Core>
#include <limits>
#include <span>
#include <vector>

#include "viewer/fields/relative_error.hpp"

namespace palpate {

/// Value of a measure that is not or cannot be measured.
inline constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();

/// An exact force and an interpolated one at the same displacement.
struct ForceComparison {
  Eigen::Vector3d exact = Eigen::Vector3d::Zero();         ///< N
  Eigen::Vector3d interpolated = Eigen::Vector3d::Zero();  ///< N
  double error_bound = not_measured;  ///< bound of the method itself, N; NaN: it gives none
  bool covered = false;               ///< all corners of the cell there are solved
};

/// Largest allowed error: force_error * |exact force|, or force_floor if that is larger.
struct AccuracyTarget {
  double force_error = usual_force_error;
  double force_floor = 0.01;  ///< N
};

/// Statistics of a set of numbers; all NaN if it is empty.
struct Spread {
  double mean = not_measured, rms = not_measured, median = not_measured;
  double percentile_95 = not_measured, percentile_99 = not_measured, maximum = not_measured;
};

/// Errors of a method at exact solutions. Shares are 0..1. NaN without measurements.
struct ErrorMeasures {
  std::size_t count = 0;
  Spread error;  ///< |interpolated - exact|, N
  /// Eq. 13 of the paper: mean of |interpolated_i - exact_i| over points and components, N.
  double mean_component = not_measured;
  double max_component = not_measured;  ///< largest component error, N
  /// Eq. 14 of the paper, corrected: mean of |interpolated_i - exact_i| / max(|exact_i|,
  /// relative_error_floor). The paper divides by exact_i, which is zero on every symmetric path.
  double mean_relative_component = not_measured;
  double max_relative_component = not_measured;  ///< largest relative component error
  Spread relative;  ///< |interpolated - exact| / max(|exact|, relative_error_floor)
  double relative_to_mean_force = not_measured;  ///< sum |interpolated - exact| / sum |exact|
  double within_target = not_measured;           ///< share of points within the AccuracyTarget
  std::size_t bounds = 0;             ///< number of points with an error bound of the method
  double bound_holds = not_measured;  ///< share of these with |error| <= bound
  Spread bound_over_error;            ///< over points with an error above zero
  double covered = not_measured;      ///< share of covered points
};

/// Measures the errors, with equal weights; all NaN if there are no points.
ErrorMeasures measureErrors(std::span<const ForceComparison> comparisons,
                            const AccuracyTarget& target);

/// Measures the errors of the covered points only; `covered` is then 1.
ErrorMeasures measureCoveredErrors(std::span<const ForceComparison> comparisons,
                                   const AccuracyTarget& target);

/// Returns the statistics of values in any order; all NaN if there are none.
Spread spreadOf(std::vector<double> values);

/// Returns the value below which `share` of the values lie, interpolated linearly between order
/// statistics (NumPy's definition). `sorted` must not be empty.
double percentile(std::span<const double> sorted, double share);

}  // namespace palpate
