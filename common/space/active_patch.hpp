#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/space/lattice.hpp"

namespace palpate {

/// Largest distance, in finger radii, from a place where a finger can stand to the nearest site. An
/// area is a surface that a finger may touch anywhere. Its sites are the finger positions that have
/// a configuration space of their own; the energy is interpolated between them. Sites lie closer
/// together where the surface bends under the finger (common/problem/sites.hpp).
inline constexpr double site_distance = 0.6;
/// Forces can be interpolated at a place of the surface if its nearest site is within this
/// distance, in finger radii. It exceeds site_distance, because that distance is ensured only at
/// discrete places, from which the sites are chosen.
inline constexpr double answered_distance = 1.1 * site_distance;

/// The contact of a soft finger with the surface at rest. Lengths in metres.
struct Finger {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< on the surface
  double radius = 0;
  /// The part of the finger's workspace ball for which configurations are computed. With unilateral
  /// contact, these are the displacements that pushing reaches (pushedAround).
  PushedPart reach = {};
  bool operator==(const Finger&) const = default;
};

/// The tool's contact with the body: the active node, and all nodes that a rigid tool moves or
/// whose mean displacement another tool prescribes.
struct ActivePatch {
  std::string name;
  std::int32_t node = -1;           ///< the active node
  std::vector<std::int32_t> nodes;  ///< sorted, contains `node`, disjoint from the fixed nodes
  /// Empty for a rigid tool. A weighted-average tool has one weight per node. The weights have sum
  /// 1 and are proportional to the surface integral of the node's shape function times the bump
  /// around the active node (bumpAt in bump_integrals.hpp). With P2 displacement some weights may
  /// be negative, because quadratic shape functions are negative in places.
  std::vector<double> weights = {};
  /// Set for a finger, which may be centred anywhere on the surface. The weights are then computed
  /// by fingerWeights() around its centre (finger_weights.hpp), and `node` is the vertex in `nodes`
  /// that is nearest to the centre.
  std::optional<Finger> finger = {};
  /// Set for a finger that is a probe place of an area. Its configuration space then consists of
  /// the rest position and this one displacement, metres.
  std::optional<Eigen::Vector3d> probe = {};
  bool operator==(const ActivePatch&) const = default;
};

}  // namespace palpate
