#pragma once

#include "worker/check/measured_ways.hpp"

namespace palpate {

/// The cost of a build that computes this number of configurations.
struct Estimate {
  std::int64_t configurations = 0;  ///< including probes
  double seconds = 0;               ///< on one core
  double bytes = 0;                 ///< size of the nodal fields, before compression
};

/// The estimated cost of a build and its reach, from measured ways. A way is a straight path of
/// tool displacements that starts at rest (measured_ways.hpp).
struct BuildCost {
  /// The cost of the uniform lattices and the probes. A build without a required accuracy computes
  /// nothing else.
  Estimate least;
  /// The cost with the points that an adaptive build adds when it halves cells. The errors measured
  /// along the ways predict how many cells are halved (WayStep::error).
  Estimate likely;
  /// Expected share of the lattice points that are reached; the others fail or lie beyond
  /// max_force.
  double reached = 1;
  /// At least half of the ways got to this distance from rest, m, rounded to whole lattice
  /// spacings.
  double usual_reach = 0;
};

/// Estimates the cost of a build from measured ways. The cost of a lattice point is the average
/// cost of the steps that the ways took at the same distance from rest. It is zero at distances
/// that no way reached because all ways had ended. If there are no ways, because the body has no
/// rest state, no point counts as reached and the cost is zero.
BuildCost buildCost(const Problem& problem, const MeasuredWays& measured);

}  // namespace palpate
