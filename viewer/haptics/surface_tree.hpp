#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "common/mesh/surface_point.hpp"

namespace palpate {

/// The nearest point of a closed surface.
struct NearestPoint : SurfacePoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();         ///< m
  double distance = std::numeric_limits<double>::infinity();  ///< m, >= 0
  /// outside the body, by the angle-weighted normal of the nearest face, edge or vertex
  bool outside = true;
};

/// The first point where a segment enters a surface.
struct Crossing : SurfacePoint {
  double fraction = 0;  ///< of the segment, 0..1
};

/// A bounding-volume hierarchy over the triangles of a closed, outward-oriented surface at rest.
/// Immutable: any thread may read. The queries are real time: they do not allocate, lock, throw or
/// log.
class SurfaceTree {
 public:
  SurfaceTree() = default;
  /// Copies what it needs. vertices: metres.
  SurfaceTree(const std::vector<Eigen::Vector3d>& vertices, const std::vector<Triangle>& triangles);

  /// Returns the nearest point, for any finite point.
  ///
  /// hint: a triangle that is likely near, such as the last one for a moving point. It shortens the
  /// search and otherwise only decides between equally near triangles.
  NearestPoint nearest(const Eigen::Vector3d& point, std::int32_t hint = -1) const noexcept;
  /// Returns the first triangle that the segment from `from` to `to` passes from outside to inside.
  /// A segment through an edge or a vertex hits one of the triangles there, so there are no cracks.
  Crossing entry(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const noexcept;

 private:
  struct Node {
    Eigen::Vector3d center, half;  ///< of the bounding box, m
    /// leaf: index into order_; otherwise the right child (the left child is the next node)
    std::int32_t first = 0;
    std::int32_t count = 0;  ///< number of triangles of a leaf; 0: not a leaf
  };
  /// Corners of a triangle, and the normals that tell inside from outside near its face, edges and
  /// vertices.
  struct Face {
    std::array<Eigen::Vector3d, 3> corners;
    Eigen::Vector3d normal;
    std::array<Eigen::Vector3d, 3> edge_normals;    ///< of the edge opposite to each corner
    std::array<Eigen::Vector3d, 3> vertex_normals;  ///< angle-weighted
  };
  void setFaces(const std::vector<Eigen::Vector3d>& vertices,
                const std::vector<Triangle>& triangles);
  std::int32_t build(std::int32_t first, std::int32_t count);

  std::vector<Node> nodes_;
  std::vector<std::int32_t> order_;  ///< triangles, leaf by leaf
  std::vector<Face> faces_;          ///< by triangle
};

}  // namespace palpate
