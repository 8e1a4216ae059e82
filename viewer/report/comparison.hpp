#pragma once

#include "viewer/report/compared_properties.hpp"
#include "viewer/report/error_measures.hpp"
#include "viewer/report/force_way.hpp"

namespace palpate {

/// Measurements of one of the two datasets at a place.
struct ComparedSide {
  double stiffness = not_measured;  ///< N/m at rest, mean over directions
  double mean_force = not_measured, largest_force = not_measured;  ///< N, over the displacements
  double mean_bound = not_measured;  ///< bound of its own interpolation, N
};

/// Mean force magnitudes over 26 directions, at one distance from rest.
struct ForceAtDistance {
  double distance;       ///< m
  double first, second;  ///< N
  double difference;     ///< magnitude of the vector difference, N
};

/// An active node of both datasets, compared at the same displacements: in the smaller ball,
/// answered by both datasets, with forces within the limits of their scenes.
struct ComparedPlace {
  std::string name;
  double apart = 0;  ///< distance between the two places at rest, m
  std::array<ComparedSide, 2> sides;
  std::size_t displacements = 0;   ///< number compared
  Spread difference;               ///< N, |second force - first force|
  double relative = not_measured;  ///< sum of differences / sum of the forces of the first dataset
  /// Along x, y and z through rest, with one interpolation each.
  std::array<std::array<ForceWay, 2>, 3> axes;
  std::vector<ForceAtDistance> distances;
};

/// Difference of the two datasets at one place.
struct PlaceDifference {
  std::string name;
  Eigen::Vector3d place;           ///< m, in the first dataset
  double relative = not_measured;  ///< as ComparedPlace::relative
};

/// Two organs or materials side by side: all measurements for text, JSON and page.
struct Comparison {
  std::vector<Dataset> open;           ///< two, in the given order
  std::vector<DatasetFacts> datasets;  ///< of the two
  std::string method;
  std::vector<std::string> differences;  ///< sceneDifferences
  std::vector<ComparedProperty> properties;
  std::size_t common = 0;                   ///< number of active nodes in both
  std::vector<ComparedPlace> places;        ///< some of these, evenly chosen if there are many
  std::vector<PlaceDifference> everywhere;  ///< at all of these, or at some hundreds of them
  std::vector<std::string> limits;          ///< sentences on its limits, with remedies
};

/// Compares two datasets of different scenes by `method`, at up to `most_places` active nodes of
/// the same name (sites of areas: also of the same place); takes some seconds. Throws Error (bad
/// input) if they have none in common.
Comparison compareDatasets(std::vector<Dataset> datasets, const std::string& method,
                           std::size_t most_places = 6);

}  // namespace palpate
