#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "common/mesh/surface_point.hpp"

namespace palpate {

/// The point of a closed surface that is nearest to a given point.
struct NearestPoint : SurfacePoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();         ///< m
  double distance = std::numeric_limits<double>::infinity();  ///< m, >= 0
  /// Whether the given point is outside the body, by the angle-weighted normal of the nearest face,
  /// edge or vertex.
  bool outside = true;
};

/// The first point where a segment enters a body through its surface.
struct Crossing : SurfacePoint {
  double fraction = 0;  ///< position on the segment, 0..1
};

/// A bounding-volume hierarchy over the triangles of a closed, outward-oriented surface at rest.
/// Immutable: any thread may read. The queries are real time: they do not allocate, lock, throw or
/// log.
class SurfaceTree {
 public:
  SurfaceTree() = default;
  /// The arguments are not needed after construction. vertices: metres.
  SurfaceTree(const std::vector<Eigen::Vector3d>& vertices, const std::vector<Triangle>& triangles);

  /// Returns the point of the surface nearest to `point`; triangle -1 if `point` is not finite.
  ///
  /// hint: a triangle that is probably near, such as the previous result for a moving point. A hint
  /// makes the search shorter. It changes the result only if several triangles are equally near.
  NearestPoint nearest(const Eigen::Vector3d& point, std::int32_t hint = -1) const noexcept;
  /// Returns the first triangle that the segment from `from` to `to` passes from outside to inside;
  /// triangle -1 if there is none. A segment through an edge or a vertex hits one of the triangles
  /// there, so there are no cracks.
  Crossing entry(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const noexcept;

 private:
  struct Node {
    Eigen::Vector3d center, half;  ///< centre and half the size of the bounding box, m
    /// index into order_ if this is a leaf; otherwise the right child (the left child is the next
    /// node)
    std::int32_t first = 0;
    std::int32_t count = 0;  ///< number of triangles of a leaf; 0: not a leaf
  };
  /// Corners of a triangle, and the normals that decide whether a point near its face, edges or
  /// vertices is inside or outside.
  struct Face {
    std::array<Eigen::Vector3d, 3> corners;
    Eigen::Vector3d normal;
    std::array<Eigen::Vector3d, 3> edge_normals;    ///< normal of the edge opposite to each corner
    std::array<Eigen::Vector3d, 3> vertex_normals;  ///< angle-weighted
  };
  void setFaces(const std::vector<Eigen::Vector3d>& vertices,
                const std::vector<Triangle>& triangles);
  std::int32_t build(std::int32_t first, std::int32_t count);

  std::vector<Node> nodes_;
  std::vector<std::int32_t> order_;  ///< indices of the triangles, leaf by leaf
  std::vector<Face> faces_;          ///< per triangle
};

}  // namespace palpate
