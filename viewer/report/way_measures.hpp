#pragma once

#include "viewer/report/error_measures.hpp"

namespace palpate {

/// An exact and an interpolated force, and how far from rest.
struct WayComparison {
  double way = 0;  ///< m, length of the displacement
  ForceComparison forces;
};

/// Shells of equal thickness that the ball is divided into.
inline constexpr std::size_t way_shells = 8;

/// Errors of all methods at the exact solutions of one shell.
struct WayShell {
  double from = 0, to = 0;             ///< m, distances from rest
  std::vector<ErrorMeasures> methods;  ///< as Report::methods
};

/// By shell from rest to `radius` (m); of each method (as Report::methods) what it was compared at.
std::vector<WayShell> measureWays(const std::vector<std::vector<WayComparison>>& methods,
                                  double radius, const AccuracyTarget& target);

}  // namespace palpate
