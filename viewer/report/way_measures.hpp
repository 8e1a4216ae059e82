#pragma once

#include "viewer/report/error_measures.hpp"

namespace palpate {

/// An exact and an interpolated force at a distance from rest.
struct WayComparison {
  double way = 0;  ///< m, length of the displacement
  ForceComparison forces;
};

/// Number of shells of equal thickness in the ball.
inline constexpr std::size_t way_shells = 8;

/// Errors of all methods at the exact solutions of one shell.
struct WayShell {
  double from = 0, to = 0;             ///< m, distances from rest
  std::vector<ErrorMeasures> methods;  ///< in the order of Report::methods
};

/// Returns the errors per shell from rest to `radius` (m). methods: comparisons per method, in the
/// order of Report::methods.
std::vector<WayShell> measureWays(const std::vector<std::vector<WayComparison>>& methods,
                                  double radius, const AccuracyTarget& target);

}  // namespace palpate
