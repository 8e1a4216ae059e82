#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/space/lattice.hpp"

namespace palpate {

/// Fingers of one radius are sites of one energy when every place between them is at most this many
/// radii from the nearest; closer where the surface bends under them (common/problem/sites.hpp).
inline constexpr double site_distance = 0.6;
/// Places a little farther are still answered for: sites are chosen among places that lie apart.
inline constexpr double answered_distance = 1.1 * site_distance;

/// Where a soft finger meets the surface at rest, and how wide it is: metres.
struct Finger {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< on the surface
  double radius = 0;
  /// What of its workspace is computed: in a scene with unilateral contact what the finger reaches
  /// by pushing at the places that it answers for.
  PushedPart reach = {};
  bool operator==(const Finger&) const = default;
};

/// The tool's contact: the active node and the nodes that it moves together.
struct ActivePatch {
  std::string name;
  std::int32_t node = -1;           ///< the active node
  std::vector<std::int32_t> nodes;  ///< sorted, contains `node`, disjoint from the fixed nodes
  /// Empty: a rigid tool. Else a weighted-average tool: one weight per node, sum 1, proportional to
  /// the integral over the surface of the node's shape function times the bump (1 -
  /// (r/radius)^2)^2. With P2 displacement some may be negative: a quadratic shape function is, in
  /// places.
  std::vector<double> weights = {};
  /// Of a finger, which is centred anywhere on the surface: then the weights are fingerWeights
  /// (finger_weights.hpp) about it, and `node` is the nearest vertex among the nodes.
  std::optional<Finger> finger = {};
  /// Of a finger where an area is measured: its space is the rest position and this one
  /// displacement, metres.
  std::optional<Eigen::Vector3d> probe = {};
  bool operator==(const ActivePatch&) const = default;
};

}  // namespace palpate
