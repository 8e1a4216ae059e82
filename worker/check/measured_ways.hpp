#pragma once

#include "common/problem/problem.hpp"

namespace palpate {

/// How a way ended. A way is a straight path of tool displacements that starts at rest.
enum class WayEnd : std::uint8_t {
  rim,        ///< reached the end of the workspace
  max_force,  ///< the force exceeded workspace.max_force, where solving ends
  failed,     ///< a transition could not be solved
  cut,        ///< a limit of the measurement was reached, or the way left the pushed part
};

/// One transition of a way. It is solved as by a worker: the start is prepared, then the target is
/// solved.
struct WayStep {
  double seconds = 0;  ///< processor time
  bool reached = false;
  /// Interpolation error of the force half a spacing before the target, relative to the error
  /// allowed in an adaptive scene. 0 if it was not measured.
  double error = 0;
};

/// A straight path from rest outward, solved in steps. For a finger that only pushes, it stays
/// within the pushed part (PushedPart). Step n (from 0) ends n + 1 lattice spacings from rest; the
/// last step ends at the rim of the workspace.
struct Way {
  std::vector<WayStep> steps;
  WayEnd end = WayEnd::rim;
};

/// The ways measured on a scene.
struct MeasuredWays {
  std::vector<Way> ways;
  std::int32_t transitions = 0;
  double seconds = 0;    ///< processor time, including the analysis of the matrix
  double stiffness = 0;  ///< N/m, largest ratio of force to displacement in first steps
  /// If the body has no rest state, the reason; otherwise empty. If set, nothing was measured,
  /// because every straight path starts at rest.
  std::string no_rest;
  /// If the first step of some way failed, the reason for the earliest such way. Otherwise empty.
  std::string no_first_step;
};

/// Limits of the measurement. It ends when one limit is reached.
struct MeasuringLimits {
  double seconds = 2;             ///< processor time; at least one transition is made
  std::int32_t transitions = 80;  ///< enough for the average cost to a few percent
};

/// Solves a few ways of the problem. Their directions and active nodes are spread evenly, and are
/// the same in every call. One thread. Error if the matrix cannot be analysed.
MeasuredWays measureWays(const Problem& problem, const MeasuringLimits& limits = {});

}  // namespace palpate
