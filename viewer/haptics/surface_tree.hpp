#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <vector>

#include "common/mesh.hpp"

namespace palpate {

/// The nearest point of a closed surface.
struct NearestPoint {
  std::int32_t triangle = -1;
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();      ///< >= 0, sum 1
  Eigen::Vector3d position = Eigen::Vector3d::Zero();         ///< m
  double distance = std::numeric_limits<double>::infinity();  ///< m, >= 0
  bool outside = true;  ///< of the body, by the angle-weighted normal of the nearest face, edge or vertex
};

/// Where a segment enters a surface first.
struct Crossing {
  std::int32_t triangle = -1;  ///< -1: it does not
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
  double fraction = 0;  ///< of the segment, 0..1
};

/// A bounding-volume hierarchy over the triangles of a closed, outward-oriented surface at rest.
/// Immutable: any thread may read. The queries are real time: they do not allocate, lock, throw or log.
class SurfaceTree {
 public:
  SurfaceTree() = default;
  /// Copies what it needs. vertices: metres.
  SurfaceTree(const std::vector<Eigen::Vector3d>& vertices, const std::vector<Triangle>& triangles);

  /// For any finite point.
  NearestPoint nearest(const Eigen::Vector3d& point) const noexcept;
  /// The first triangle that the segment from `from` to `to` passes from outside to inside. A segment
  /// through an edge or a vertex hits one of the triangles there: there are no cracks.
  Crossing entry(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const noexcept;
};

}  // namespace palpate
