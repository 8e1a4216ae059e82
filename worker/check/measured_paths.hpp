#pragma once

#include "common/problem/problem.hpp"

namespace palpate {

/// How a Path ended.
enum class PathEnd : std::uint8_t {
  rim,        ///< reached the end of the workspace
  max_force,  ///< the force exceeded workspace.max_force
  failed,     ///< a transition could not be solved
  cut,        ///< a limit of the measurement was reached, or the path left the pushed part
};

/// One transition of a Path. It is solved as a worker would do it: prepare the start, then solve
/// for the target.
struct PathStep {
  double seconds = 0;  ///< processor time
  bool reached = false;
  /// Interpolation error of the force half a spacing before the target, relative to the error
  /// allowed in an adaptive scene. 0 if it was not measured.
  double error = 0;
};

/// A straight path of tool displacements from rest outward, solved in steps. For a finger that only
/// pushes, it stays within the pushed part (PushedPart). Step n (from 0) ends n + 1 lattice
/// spacings from rest; the last step ends at the rim of the workspace.
struct Path {
  std::vector<PathStep> steps;
  PathEnd end = PathEnd::rim;
};

/// The paths measured on a scene.
struct MeasuredPaths {
  std::vector<Path> paths;
  std::int32_t transitions = 0;
  double seconds = 0;    ///< processor time, including the analysis of the matrix
  double stiffness = 0;  ///< N/m, largest ratio of force to displacement in first steps
  /// Reason why the body has no rest state, otherwise empty. Without a rest state nothing is
  /// measured, because every path starts at rest.
  std::string no_rest;
  /// Reason of the earliest failure of a first step; empty if there is none.
  std::string no_first_step;
};

/// Limits of the measurement. It ends when one limit is reached.
struct MeasuringLimits {
  double seconds = 2;             ///< processor time; at least one transition is made
  std::int32_t transitions = 80;  ///< gives the average cost to a few percent
};

/// Solves a few paths of the problem. Their directions and active nodes are spread evenly, and are
/// the same in every call. One thread. Error if the matrix cannot be analysed.
MeasuredPaths measurePaths(const Problem& problem, const MeasuringLimits& limits = {});

}  // namespace palpate
