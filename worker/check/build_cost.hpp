#pragma once

#include "worker/check/measured_paths.hpp"

namespace palpate {

/// The cost of a build that computes this number of configurations.
struct Estimate {
  std::int64_t configurations = 0;  ///< including probes
  double seconds = 0;               ///< on one core
  std::int64_t bytes = 0;           ///< size of the nodal fields, before compression
};

/// The estimated cost of a build and its reach, from measured paths (measured_paths.hpp).
struct BuildCost {
  /// The cost of the uniform lattices and the probes. A build without a required accuracy computes
  /// nothing else.
  Estimate least;
  /// The cost with the points that an adaptive build adds when it splits cells. The errors measured
  /// along the paths predict how many cells are split (PathStep::error).
  Estimate likely;
  /// Expected share of the lattice points that are reached; the others fail or lie beyond
  /// max_force.
  double reached = 1;
  /// Largest distance from rest, m, at which at least half of the lattice points are reached: a
  /// multiple of the spacing, or the radius.
  double usual_reach = 0;
};

/// Estimates the cost of a build from measured paths. The cost of a lattice point is the average
/// cost of the steps that the paths took at the same distance from rest. It is zero at distances
/// that no path reached because all paths had ended. If there are no paths, because the body has no
/// rest state, the cost and the share of reached points are zero.
BuildCost buildCost(const Problem& problem, const MeasuredPaths& measured);

}  // namespace palpate
