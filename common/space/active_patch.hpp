#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/space/lattice.hpp"

namespace palpate {

/// Largest distance, in finger radii, from any place of an area to its nearest site. Sites of
/// fingers of one radius that lie this close share one energy. They lie closer where the surface
/// bends under the finger (common/problem/sites.hpp).
inline constexpr double site_distance = 0.6;
/// Largest distance, in finger radii, from a place that is answered to the nearest site. It exceeds
/// site_distance, because sites are chosen among places that lie apart.
inline constexpr double answered_distance = 1.1 * site_distance;

/// The contact of a soft finger with the surface at rest: centre and radius, metres.
struct Finger {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< on the surface
  double radius = 0;
  /// The computed part of its workspace. With unilateral contact it is the part that the finger
  /// reaches by pushing at the places that this site answers for.
  PushedPart reach = {};
  bool operator==(const Finger&) const = default;
};

/// The tool's contact: the active node and the nodes that it moves together.
struct ActivePatch {
  std::string name;
  std::int32_t node = -1;           ///< the active node
  std::vector<std::int32_t> nodes;  ///< sorted, contains `node`, disjoint from the fixed nodes
  /// Empty for a rigid tool. A weighted-average tool has one weight per node with sum 1,
  /// proportional to the surface integral of the node's shape function times the bump (1 -
  /// (r/radius)^2)^2. With P2 displacement some weights may be negative, because quadratic shape
  /// functions are negative in places.
  std::vector<double> weights = {};
  /// Set for a finger, which may be centred anywhere on the surface. The weights are then
  /// fingerWeights (finger_weights.hpp) about its centre, and `node` is the nearest vertex among
  /// the nodes.
  std::optional<Finger> finger = {};
  /// Set for a finger that probes an area. Its space then consists of the rest position and this
  /// one displacement, metres.
  std::optional<Eigen::Vector3d> probe = {};
  bool operator==(const ActivePatch&) const = default;
};

}  // namespace palpate
