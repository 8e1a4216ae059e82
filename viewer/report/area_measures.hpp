#pragma once

#include "common/dataset/dataset.hpp"
#include "viewer/report/error_measures.hpp"
#include "viewer/report/force_way.hpp"

namespace palpate {

/// Error bounds of a finger's area at one depth, over its whole surface, and its errors at the
/// probes between the previous depth and this one.
struct DepthMeasures {
  double depth = 0;  ///< m, length of the displacements
  Spread bound;      ///< relative to the force, or to force_floor / force_error (AccuracyTarget) if
                     ///< that is larger
  double force = not_measured;  ///< mean force where the bound is sampled, N
  std::size_t exact = 0;        ///< number of probes
  Spread error;                 ///< relative, like `bound`
};

/// Errors of an area at the dataset's probes, which are exact solutions at random places. `counts`
/// covers all probes, the other members only those whose force is at most the scene's max_force.
struct AreaProbes {
  ProbeCounts counts;
  std::size_t unanswered = 0;  ///< probes at which the area gives no bound
  ErrorMeasures area;          ///< errors of the area, with the bounds
  Spread error;                ///< relative, as DepthMeasures::error
  ErrorMeasures nearest_site;  ///< errors if only the space of the nearest site is used
  /// One probe.
  struct Comparison {
    Eigen::Vector3d place;         ///< m
    Eigen::Vector3d displacement;  ///< m
    Eigen::Vector3d force;         ///< exact, N
    double error;                  ///< relative, as DepthMeasures::error
    double newtons;                ///< the same error in newtons
    double newtons_of_nearest;     ///< error if only the space of the nearest site is used, N
  };
  std::vector<Comparison> comparisons;
};

/// Error bounds of the energy of a finger's area, and its errors at probes. The bounds are sampled
/// at displacements within 45 degrees of the inward normal whose force is at most the scene's
/// max_force. The probes cover all displacements that contact can reach.
struct AreaMeasures {
  std::string name;
  std::size_t sites = 0, collocation_points = 0;
  double seconds_to_prepare = not_measured, nanoseconds = not_measured;  ///< nanoseconds: time of
                                                                         ///< one query
  std::size_t samples = 0;
  Spread bound;  ///< relative, as DepthMeasures::bound
  std::vector<DepthMeasures> depths;
  /// Per triangle of the mesh's surface: median of the relative bound at its centroid, over all
  /// displacements that are sampled there; NaN if the area gives no answer there.
  std::vector<double> on_triangles;
  std::vector<double> worst_on_triangles;  ///< like on_triangles, but the maximum
  AreaProbes probes;
  /// Forces along at most six straight paths from rest. Three start at sites and lead into the
  /// body, along the lattice axis that is nearest to the inward normal. The others lead to the
  /// probes that tellingOnes() chooses. ForceWay::sampled holds two interpolations: the area, and
  /// the space of the nearest site alone.
  std::vector<ForceWay> ways;
  std::size_t jumps = 0;  ///< number of inconsistent lattice edges of all sites
};

/// Measures all areas of a dataset, in the order of the scene. Takes a few seconds per area, on all
/// cores.
std::vector<AreaMeasures> measureAreas(const Dataset& dataset, const AccuracyTarget& target);

}  // namespace palpate
