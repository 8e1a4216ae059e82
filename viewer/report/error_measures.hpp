#pragma once

#include <Eigen/Core>
#include <limits>
#include <span>
#include <vector>

#include "viewer/fields/relative_error.hpp"

namespace palpate {

/// What a measure is before it is measured, and where it cannot be.
inline constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();

/// An exact force and what a method of interpolation says at the same displacement.
struct ForceComparison {
  Eigen::Vector3d exact = Eigen::Vector3d::Zero();         ///< N
  Eigen::Vector3d interpolated = Eigen::Vector3d::Zero();  ///< N
  double error_bound = not_measured;  ///< N, the method's own; NaN: it gives none
  bool covered = false;               ///< every corner of the cell there is solved
};

/// Which errors are allowed: at most force_error of |exact force|, or force_floor where that is
/// more.
struct AccuracyTarget {
  double force_error = usual_force_error;
  double force_floor = 0.01;  ///< N
};

/// Where numbers lie. All NaN when there is none.
struct Spread {
  double mean = not_measured, rms = not_measured, median = not_measured;
  double percentile_95 = not_measured, percentile_99 = not_measured, maximum = not_measured;
};

/// How far a method is from exact solutions. Every share is 0..1. NaN where nothing could be
/// measured.
struct ErrorMeasures {
  std::size_t count = 0;
  Spread error;  ///< |interpolated - exact|, N
  /// Eq. 13 of the paper: mean over points and components of |interpolated_i - exact_i|, N.
  double mean_component = not_measured;
  double max_component = not_measured;  ///< the largest of them, N
  /// Eq. 14 of the paper, corrected: the same of |interpolated_i - exact_i| / max(|exact_i|,
  /// relative_error_floor). The paper divides by exact_i, which is zero on every symmetric path.
  double mean_relative_component = not_measured;
  double max_relative_component = not_measured;  ///< the largest of them
  Spread relative;  ///< |interpolated - exact| / max(|exact|, relative_error_floor)
  double relative_to_mean_force = not_measured;  ///< sum of |interpolated - exact| / of |exact|
  double within_target = not_measured;           ///< share of points that keep the AccuracyTarget
  std::size_t bounds = 0;             ///< points for which the method gave an error bound
  double bound_holds = not_measured;  ///< share of those with |error| <= bound
  Spread bound_over_error;            ///< over those with an error above zero
  double covered = not_measured;      ///< share of points
};

/// Of points that count alike; all NaN when there is none.
ErrorMeasures measureErrors(std::span<const ForceComparison> comparisons,
                            const AccuracyTarget& target);

/// The same over the covered points alone; covered is then 1.
ErrorMeasures measureCoveredErrors(std::span<const ForceComparison> comparisons,
                                   const AccuracyTarget& target);

/// In any order; all NaN when there is none.
Spread spreadOf(std::vector<double> values);

/// `share` of the values lie below it: linear between order statistics (the definition NumPy uses).
/// `sorted` must not be empty.
double percentile(std::span<const double> sorted, double share);

}  // namespace palpate
