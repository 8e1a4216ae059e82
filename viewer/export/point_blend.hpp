#pragma once

#include "viewer/fields/cell_data.hpp"

namespace palpate {

/// A multiple of what a lattice point has.
struct PointShare {
  std::int32_t point = -1;  ///< lattice number
  double factor = 0;
};

/// Of which configurations, and of how much of each, the shape of a body between them is made: the
/// interpolation of DisplacementField and PressureField without their nodes, for who reads those
/// few configurations from the dataset. Nothing is rounded to modes.
///
/// Immutable: any number of threads may ask at once.
class PointBlend {
 public:
  /// Copies what it needs. Error when no point of the space is solved.
  explicit PointBlend(const SpaceTable& space);

  /// Solved points in ascending order, each once; their factors, some of which may be negative
  /// where corners are continued, sum to 1. In a solved point itself it alone. Outside of the ball
  /// those of the nearest point of the sphere, those at rest for NaN.
  std::vector<PointShare> sharesAt(const Eigen::Vector3d& displacement) const;

 private:
  explicit PointBlend(const CellBranches& data);

  CellTree tree_;
  std::vector<std::vector<PointShare>> shares_;  ///< per slot
};

}  // namespace palpate
