#pragma once

#include "viewer/report/error_measures.hpp"

namespace palpate {

/// An exact and an interpolated force, and their distance from rest.
struct DistanceComparison {
  double distance = 0;  ///< m, length of the displacement
  ForceComparison forces;
};

/// Number of spherical shells of equal thickness into which the ball is divided.
inline constexpr std::size_t shell_count = 8;

/// Errors of all methods at the exact solutions in one shell.
struct ErrorShell {
  double from = 0, to = 0;             ///< m, distances from rest
  std::vector<ErrorMeasures> methods;  ///< in the order of Report::methods
};

/// Returns the errors in each shell from rest to `radius` (m). methods: the comparisons of each
/// method, in the order of Report::methods.
std::vector<ErrorShell> measureShells(const std::vector<std::vector<DistanceComparison>>& methods,
                                      double radius, const AccuracyTarget& target);

}  // namespace palpate
