#pragma once

#include "worker/check/measured_ways.hpp"

namespace palpate {

/// The cost of a build with this number of configurations.
struct Estimate {
  std::int64_t configurations = 0;  ///< including probes
  double seconds = 0;               ///< on one core
  double bytes = 0;                 ///< of nodal fields, before compression
};

/// The estimated cost of a build and its reach, from measured ways.
struct BuildCost {
  /// The uniform lattices and the probes. For a build without accuracy this is everything.
  Estimate least;
  /// With the points added by an adaptive build where cells are halved, as the ways predict
  /// (WayStep).
  Estimate likely;
  /// Expected share of the lattice points that are reached; the others fail or lie beyond
  /// max_force.
  double reached = 1;
  /// Distance that half of the ways reached, m, rounded down to whole lattice spacings.
  double usual_reach = 0;
};

/// Estimates the cost of a build from measured ways. A lattice point costs the average of the ways
/// at the same distance from rest, and nothing where all ways have ended. Without any way (no rest
/// state) no point is reached, at no cost.
BuildCost buildCost(const Problem& problem, const MeasuredWays& measured);

}  // namespace palpate
