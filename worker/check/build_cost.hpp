#pragma once

#include "worker/check/measured_ways.hpp"

namespace palpate {

/// What a build of so many configurations amounts to.
struct Estimate {
  std::int64_t configurations = 0;  ///< probes too
  double seconds = 0;               ///< on one core
  double bytes = 0;                 ///< of nodal fields, before compression
};

/// What a build will cost and how far it will get, from what was measured.
struct BuildCost {
  /// The uniform lattices and the probes: all there is of a build without accuracy.
  Estimate least;
  /// With the points of the cells that an adaptive build will halve, as the ways tell (WayStep).
  Estimate likely;
  /// Share of the lattice points that are reached: others lie beyond max_force or failures.
  double reached = 1;
  /// m: half of the ways got this far, rounded down to lattice spacings.
  double usual_reach = 0;
};

/// Points of the lattice cost what the ways took at the same distance from rest, on average;
/// nothing where the ways had ended. Without any way (no rest state) nothing is reached, at no
/// cost.
BuildCost buildCost(const Problem& problem, const MeasuredWays& measured);

}  // namespace palpate
