#pragma once

#include <Eigen/Core>
#include <limits>
#include <span>
#include <vector>

#include "viewer/fields/relative_error.hpp"

namespace palpate {

/// Value of a measure that was not measured or cannot be measured.
inline constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();

/// An exact force and an interpolated force at the same displacement.
struct ForceComparison {
  Eigen::Vector3d exact = Eigen::Vector3d::Zero();         ///< N
  Eigen::Vector3d interpolated = Eigen::Vector3d::Zero();  ///< N
  double error_bound = not_measured;  ///< the method's own bound of its error, N; NaN if it gives
                                      ///< none
  bool covered = false;               ///< all corners of the cell that contains the displacement
                                      ///< are solved
  double distance = not_measured;     ///< m, length of the displacement; used only for shells
};

/// Largest allowed error of a force: force_error times the magnitude of the exact force, but at
/// least force_floor.
struct AccuracyTarget {
  double force_error = usual_force_error;
  double force_floor = 0.01;  ///< N
};

/// Statistics of a set of numbers; all are NaN if the set is empty.
struct Spread {
  double mean = not_measured, rms = not_measured, median = not_measured;
  double percentile_95 = not_measured, percentile_99 = not_measured, maximum = not_measured;
};

/// Errors of a method at exact solutions. Fractions are 0 to 1. A measure without data is NaN.
struct ErrorMeasures {
  std::size_t count = 0;
  Spread error;  ///< |interpolated - exact|, N
  /// Mean of |interpolated_i - exact_i| over points and components i, N; Eq. 13 of the paper.
  double mean_component = not_measured;
  double max_component = not_measured;  ///< largest error of a component, N
  /// Mean of |interpolated_i - exact_i| / max(|exact_i|, relative_error_floor); Eq. 14 of the
  /// paper, corrected. The paper divides by exact_i, which is zero on every symmetric path.
  double mean_relative_component = not_measured;
  double max_relative_component = not_measured;  ///< largest relative error of a component
  Spread relative;  ///< |interpolated - exact| / max(|exact|, relative_error_floor)
  double relative_to_mean_force = not_measured;  ///< sum |interpolated - exact| / sum |exact|
  double within_target = not_measured;           ///< fraction of points that meet the
                                                 ///< AccuracyTarget
  std::size_t bounds = 0;             ///< number of points where the method gives an error bound
  double bound_holds = not_measured;  ///< fraction of these points where |error| <= bound
  Spread bound_over_error;            ///< bound divided by error, over points with an error above
                                      ///< zero
  double covered = not_measured;      ///< fraction of points that are covered
};

/// Measures the errors; all points have the same weight. All measures are NaN if there are no
/// points.
ErrorMeasures measureErrors(std::span<const ForceComparison> comparisons,
                            const AccuracyTarget& target);

/// Measures the errors of the covered points only, so ErrorMeasures::covered is 1.
ErrorMeasures measureCoveredErrors(std::span<const ForceComparison> comparisons,
                                   const AccuracyTarget& target);

/// Returns the statistics of values in any order; all are NaN if there are no values.
Spread spreadOf(std::vector<double> values);

/// Returns the value below which the fraction `share` of the values lie. Interpolates linearly
/// between neighbouring values of the sorted list (NumPy's default definition). `sorted` must not
/// be empty.
double percentile(std::span<const double> sorted, double share);

/// Number of spherical shells of equal thickness into which the ball is divided.
inline constexpr std::size_t shell_count = 8;

/// Errors of all methods at the exact solutions in one shell.
struct ErrorShell {
  double from = 0, to = 0;             ///< m, distances from rest
  std::vector<ErrorMeasures> methods;  ///< in the order of Report::methods
};

/// Returns the errors in each shell from rest to `radius` (m). methods: the comparisons of each
/// method, in the order of Report::methods.
std::vector<ErrorShell> measureShells(const std::vector<std::vector<ForceComparison>>& methods,
                                      double radius, const AccuracyTarget& target);

}  // namespace palpate
