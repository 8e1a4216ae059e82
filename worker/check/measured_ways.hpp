#pragma once

#include "common/problem/problem.hpp"

namespace palpate {

/// The end of a way from rest.
enum class WayEnd : std::uint8_t {
  rim,        ///< reached the end of the workspace
  max_force,  ///< the force exceeded workspace.max_force, where solving ends
  failed,     ///< a transition could not be solved
  cut,        ///< the measurement was over, or the way left the pushed part
};

/// One transition, as a worker makes it: its start is prepared, then the target is solved.
struct WayStep {
  double seconds = 0;  ///< processor time
  bool reached = false;
  /// Interpolation error of the force half a spacing before the target, relative to the error
  /// allowed in an adaptive scene. 0 if it was not measured.
  double error = 0;
};

/// A straight way from rest outward; for a finger that only pushes, within the pushed part. Step n
/// (from 0) leads to n + 1 lattice spacings, the last one to the rim.
struct Way {
  std::vector<WayStep> steps;
  WayEnd end = WayEnd::rim;
};

/// The ways measured on a scene.
struct MeasuredWays {
  std::vector<Way> ways;
  std::int32_t transitions = 0;
  double seconds = 0;    ///< processor time, including the analysis of the matrix
  double stiffness = 0;  ///< N/m, largest force over displacement of the first steps
  /// Why the body has no rest state to start from; usually empty. If set, there are no ways.
  std::string no_rest;
  /// Why the first way without a successful step failed; empty if there is none.
  std::string no_first_step;
};

/// Limits of the measurement. It ends when one of them is reached.
struct MeasuringLimits {
  double seconds = 2;             ///< processor time; at least one transition is made
  std::int32_t transitions = 80;  ///< gives the average cost to a few percent
};

/// Solves a few ways of the problem. Directions and active nodes are spread evenly and are the same
/// every time. One thread. Error if the matrix cannot be analysed.
MeasuredWays measureWays(const Problem& problem, const MeasuringLimits& limits = {});

}  // namespace palpate
