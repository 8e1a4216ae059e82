#pragma once

#include "common/problem/problem.hpp"

namespace palpate {

/// How a way from rest ended.
enum class WayEnd : std::uint8_t {
  rim,        ///< at the end of the workspace
  max_force,  ///< the force exceeded workspace.max_force: nothing is solved beyond
  failed,     ///< the transition could not be solved
  cut,        ///< the measurement had taken long enough
};

/// One transition, as a worker makes it: its start made ready, the target reached from it.
struct WayStep {
  double seconds = 0;  ///< of the processor
  bool reached = false;
  /// Error of the force half a spacing before the target, interpolated from both ends, as a share
  /// of what an adaptive scene allows there; 0 where it was not measured.
  double error = 0;
};

/// A straight way from rest outward, of a finger that only pushes in the part of its lattice. Step
/// n (from 0) leads to (n + 1) lattice spacings, the last to the rim.
struct Way {
  std::vector<WayStep> steps;
  WayEnd end = WayEnd::rim;
};

/// What was measured on a scene.
struct MeasuredWays {
  std::vector<Way> ways;
  std::int32_t transitions = 0;
  double seconds = 0;    ///< of the processor, the analysis of the matrix included
  double stiffness = 0;  ///< N/m, the largest of the first steps: force over displacement
  /// Why the body has no rest state to start from; empty as a rule. Then there are no ways.
  std::string no_rest;
  /// Why the first step of the first way that got nowhere failed; empty when all got somewhere.
  std::string no_first_step;
};

/// How long to measure: until one of the two is used up.
struct MeasuringLimits {
  double seconds = 2;             ///< of the processor; at least one transition is made
  std::int32_t transitions = 80;  ///< as many as tell the cost of an average one to a few percent
};

/// Solves a few ways of the problem, in directions and from active nodes that are spread evenly,
/// the same ones every time. One thread; Error when the matrix cannot be analysed.
MeasuredWays measureWays(const Problem& problem, const MeasuringLimits& limits = {});

}  // namespace palpate
