#pragma once

#include "common/dataset/dataset.hpp"
#include "viewer/report/error_measures.hpp"

namespace palpate {

/// What the error bound of a finger's area says at one depth, all over its surface.
struct DepthMeasures {
  double depth = 0;  ///< m, length of the displacements
  Spread bound;      ///< relative: of the force, or of what the target allows as if it were it
  double force = not_measured;  ///< N, mean
};

/// How sure the one energy of a finger's area is of its forces, by its own error bound: there are
/// no exact solutions between sites in a dataset. Displacements press within 45 degrees of the
/// inward normal, by forces up to the scene's largest.
struct AreaMeasures {
  std::string name;
  std::size_t sites = 0, stations = 0;
  double seconds_to_prepare = not_measured, nanoseconds = not_measured;  ///< per query
  std::size_t samples = 0;
  Spread bound;  ///< relative, as DepthMeasures::bound
  std::vector<DepthMeasures> depths;
  /// Per triangle of the mesh's surface: median of the relative bound in its middle; NaN where the
  /// area does not answer.
  std::vector<double> on_triangles;
};

/// Of all areas of a dataset, in the order of the scene. Takes seconds each, on all cores.
std::vector<AreaMeasures> measureAreas(const Dataset& dataset, const AccuracyTarget& target);

}  // namespace palpate
