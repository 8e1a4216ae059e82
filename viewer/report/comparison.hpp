#pragma once

#include "viewer/report/compared_properties.hpp"
#include "viewer/report/error_measures.hpp"
#include "viewer/report/force_way.hpp"

namespace palpate {

/// What one of the two datasets says at a place.
struct ComparedSide {
  double stiffness = not_measured;  ///< N/m at rest, mean over directions
  double mean_force = not_measured, largest_force = not_measured;  ///< N, over the displacements
  double mean_bound = not_measured;  ///< N, of its own interpolation, over the same
};

/// Mean lengths of forces over 26 directions, at one distance from rest.
struct ForceAtDistance {
  double distance;       ///< m
  double first, second;  ///< N
  double difference;     ///< N, of the vectors
};

/// An active node that both datasets have, along the same displacements: those of the smaller ball
/// that both answer, with forces within the limits of their scenes.
struct ComparedPlace {
  std::string name;
  double apart = 0;  ///< m between the two places at rest
  std::array<ComparedSide, 2> sides;
  std::size_t displacements = 0;   ///< compared
  Spread difference;               ///< N, |second force - first force|
  double relative = not_measured;  ///< sum of differences / sum of the forces of the first
  /// Through rest along x, y and z, with one interpolation each.
  std::array<std::array<ForceWay, 2>, 3> axes;
  std::vector<ForceAtDistance> distances;
};

/// How far the two are from each other at one place.
struct PlaceDifference {
  std::string name;
  Eigen::Vector3d place;           ///< m, in the first
  double relative = not_measured;  ///< as ComparedPlace
};

/// Two organs or materials side by side: everything that text, JSON and page say, measured.
struct Comparison {
  std::vector<Dataset> open;           ///< two, as given
  std::vector<DatasetFacts> datasets;  ///< of them
  std::string method;
  std::vector<std::string> differences;  ///< sceneDifferences
  std::vector<ComparedProperty> properties;
  std::size_t common = 0;                   ///< active nodes that can be compared
  std::vector<ComparedPlace> places;        ///< these, evenly chosen where there are many
  std::vector<PlaceDifference> everywhere;  ///< at all of them, at most some hundreds
  std::vector<std::string> limits;          ///< sentences: what is not compared, and what to do
};

/// Compares two datasets that are not of one scene by `method`, at up to `most_places` active nodes
/// of the same name (sites of areas: of the same place too); some seconds. Error (bad input) when
/// they have none in common.
Comparison compareDatasets(std::vector<Dataset> datasets, const std::string& method,
                           std::size_t most_places = 6);

}  // namespace palpate
