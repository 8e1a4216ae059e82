#pragma once

#include "viewer/report/dataset_facts.hpp"
#include "viewer/report/error_measures.hpp"
#include "viewer/report/force_way.hpp"

namespace palpate {

/// A property and its values in two datasets, in words.
struct ComparedProperty {
  std::string name, first, second;
};

/// Measurements of one of the two datasets at one place.
struct ComparedSide {
  double stiffness = not_measured;  ///< N/m at rest, mean over directions
  double mean_force = not_measured, largest_force = not_measured;  ///< N, over the displacements
                                                                   ///< that are compared
  double mean_bound = not_measured;  ///< mean error bound of the interpolated forces, N
};

/// Mean magnitudes of the forces over 26 directions, at one distance from rest.
struct ForceAtDistance {
  double distance;       ///< m
  double first, second;  ///< N
  double difference;     ///< mean magnitude of the vector difference, N
};

/// An active node of both datasets, with the forces of both at the same displacements. A
/// displacement is compared if it lies in the smaller of the two balls, both datasets give a force
/// there, and each force is at most the max_force of its scene.
struct ComparedPlace {
  std::string name;
  double apart = 0;  ///< distance between the rest positions of the two places, m
  std::array<ComparedSide, 2> sides;
  std::size_t displacements = 0;   ///< number of displacements that are compared
  Spread difference;               ///< N, |second force - first force|
  double relative = not_measured;  ///< sum of differences / sum of the forces of the first dataset
  /// Forces on lines through rest along x, y and z, [axis][dataset], by Comparison::method only.
  std::array<std::array<ForceWay, 2>, 3> axes;
  std::vector<ForceAtDistance> distances;
};

/// Difference between the two datasets at one place.
struct PlaceDifference {
  std::string name;
  Eigen::Vector3d place;           ///< m, in the first dataset
  double relative = not_measured;  ///< as ComparedPlace::relative
};

/// Comparison of two organs or materials: all measurements that the text, the JSON and the page
/// show.
struct Comparison {
  std::vector<Dataset> open;           ///< two, in the given order
  std::vector<DatasetFacts> datasets;  ///< facts of the two datasets
  std::string method;
  std::vector<std::string> differences;  ///< as sceneDifferences() returns them
  std::vector<ComparedProperty> properties;
  std::size_t common = 0;                   ///< number of active nodes that both datasets have
  std::vector<ComparedPlace> places;        ///< the common active nodes; evenly chosen ones if
                                            ///< there are many
  std::vector<PlaceDifference> everywhere;  ///< at most 400 of the common active nodes
  std::vector<std::string> limits;          ///< sentences about the limits of the comparison, with
                                            ///< remedies
};

/// Compares the forces of two datasets of different scenes, interpolated by `method`. Compares up
/// to `most_places` active nodes that have the same name in both datasets; sites of areas must also
/// have the same place. Takes a few seconds. Throws Error (bad input) if the datasets have no
/// active node in common.
Comparison compareDatasets(std::vector<Dataset> datasets, const std::string& method,
                           std::size_t most_places = 6);

}  // namespace palpate
