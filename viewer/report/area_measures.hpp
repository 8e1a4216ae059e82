#pragma once

#include "common/dataset/dataset.hpp"
#include "viewer/report/error_measures.hpp"
#include "viewer/report/force_way.hpp"

namespace palpate {

/// What the error bound of a finger's area says at one depth, all over its surface, and the errors
/// at probes from the depth before it to this one.
struct DepthMeasures {
  double depth = 0;  ///< m, length of the displacements
  Spread bound;      ///< relative: of the force, or of what the target allows as if it were it
  double force = not_measured;  ///< N, mean
  std::size_t exact = 0;        ///< probes
  Spread error;                 ///< relative like the bound
};

/// What exact solutions at random places of an area say of it: the dataset's probes. The others
/// are those within the scene's largest force.
struct AreaProbes {
  ProbeCounts counts;
  std::size_t unanswered = 0;  ///< within the force, but the area gives no bound there
  ErrorMeasures area;          ///< of all within the force, with the bounds
  Spread error;                ///< of those, relative as DepthMeasures::error
  ErrorMeasures nearest_site;  ///< of what the space of the nearest site says alone
  /// One within the force.
  struct Comparison {
    Eigen::Vector3d place;         ///< m
    Eigen::Vector3d displacement;  ///< m
    Eigen::Vector3d force;         ///< exact, N
    double error;                  ///< relative, as DepthMeasures::bound
    double newtons;                ///< the same error, N
    double newtons_of_nearest;     ///< of what the nearest site says alone, N
  };
  std::vector<Comparison> comparisons;
};

/// How sure the one energy of a finger's area is of its forces, by its own error bound, and how
/// wrong it is at the probes. Displacements of the bound press within 45 degrees of the inward
/// normal, by forces up to the scene's largest; those of the probes are all that contact reaches.
struct AreaMeasures {
  std::string name;
  std::size_t sites = 0, collocation_points = 0;
  double seconds_to_prepare = not_measured, nanoseconds = not_measured;  ///< per query
  std::size_t samples = 0;
  Spread bound;  ///< relative, as DepthMeasures::bound
  std::vector<DepthMeasures> depths;
  /// Per triangle of the mesh's surface: median of the relative bound in its middle; NaN where the
  /// area does not answer.
  std::vector<double> on_triangles;
  std::vector<double> worst_on_triangles;  ///< the largest there, in place of the median
  AreaProbes probes;
  /// Into the body at three sites, along the axis of the lattice that is nearest to the inward
  /// normal, and from rest to probes of telling errors; at most six. Interpolations: the area, and
  /// the space of the nearest site alone.
  std::vector<ForceWay> ways;
  std::size_t jumps = 0;  ///< lattice edges of the sites whose ends are on different branches
};

/// Of all areas of a dataset, in the order of the scene. Takes seconds each, on all cores.
std::vector<AreaMeasures> measureAreas(const Dataset& dataset, const AccuracyTarget& target);

}  // namespace palpate
