#pragma once

#include "common/dataset/dataset.hpp"
#include "viewer/report/error_measures.hpp"
#include "viewer/report/force_way.hpp"

namespace palpate {

/// Error bounds of a finger's area at one depth, over its whole surface, and errors at the probes
/// between the previous depth and this one.
struct DepthMeasures {
  double depth = 0;  ///< m, length of the displacements
  Spread bound;      ///< relative to the force, or to force_floor / force_error if that is larger
  double force = not_measured;  ///< N, mean
  std::size_t exact = 0;        ///< number of probes
  Spread error;                 ///< relative, as `bound`
};

/// Errors of an area at exact solutions at random places, the dataset's probes. All but `counts`
/// cover only probes within the scene's largest force.
struct AreaProbes {
  ProbeCounts counts;
  std::size_t unanswered = 0;  ///< probes without a bound of the area
  ErrorMeasures area;          ///< errors of the area, with the bounds
  Spread error;                ///< relative, as DepthMeasures::error
  ErrorMeasures nearest_site;  ///< errors of the nearest site's space alone
  /// One probe.
  struct Comparison {
    Eigen::Vector3d place;         ///< m
    Eigen::Vector3d displacement;  ///< m
    Eigen::Vector3d force;         ///< exact, N
    double error;                  ///< relative, as DepthMeasures::error
    double newtons;                ///< the same error in newtons
    double newtons_of_nearest;     ///< error of the nearest site's space alone, N
  };
  std::vector<Comparison> comparisons;
};

/// Error bounds of the energy of a finger's area, and its errors at probes. Bounds are sampled at
/// displacements within 45 degrees of the inward normal, with forces up to the scene's largest;
/// probes cover all displacements that contact reaches.
struct AreaMeasures {
  std::string name;
  std::size_t sites = 0, collocation_points = 0;
  double seconds_to_prepare = not_measured, nanoseconds = not_measured;  ///< nanoseconds: per query
  std::size_t samples = 0;
  Spread bound;  ///< relative, as DepthMeasures::bound
  std::vector<DepthMeasures> depths;
  /// Per triangle of the mesh's surface: median of the relative bound at its centroid; NaN if the
  /// area gives no answer there.
  std::vector<double> on_triangles;
  std::vector<double> worst_on_triangles;  ///< the maximum in place of the median
  AreaProbes probes;
  /// At most six paths: into the body at three sites, along the lattice axis nearest to the inward
  /// normal, and from rest to the probes of tellingOnes(). Interpolations: the area, and the
  /// nearest site's space alone.
  std::vector<ForceWay> ways;
  std::size_t jumps = 0;  ///< lattice edges of the sites whose ends are on different branches
};

/// Measures all areas of a dataset, in the order of the scene. Takes seconds per area, on all
/// cores.
std::vector<AreaMeasures> measureAreas(const Dataset& dataset, const AccuracyTarget& target);

}  // namespace palpate
