#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "common/base/index.hpp"
#include "common/dataset/dataset.hpp"
#include "viewer/haptics/surface_tree.hpp"

namespace palpate {

/// Weight of one configuration space in a blended force.
struct SpaceWeight {
  std::int32_t space = -1;
  double weight = 0;
};

/// Largest number of spaces in the blend of a vertex, and in the blend of a triangle, which has
/// three vertices.
inline constexpr std::size_t most_spaces_of_vertex = 3;
inline constexpr std::size_t most_blended_spaces = 3 * most_spaces_of_vertex;

/// Weights of one space at the three corners of a triangle. They are interpolated linearly in
/// between.
struct CornerShares {
  std::int32_t space = -1;
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();
};

/// Weights of the spaces at a point of the surface. Only the first `size` entries are valid. They
/// are distinct spaces, and their weights sum to 1.
struct SpaceBlend {
  std::array<SpaceWeight, most_blended_spaces> shares;
  std::int32_t size = 0;
  std::span<const SpaceWeight> used() const noexcept { return std::span(shares).first(at(size)); }
};

/// Sites of a finger that share one energy over a part of the surface (AreaField).
struct TouchArea {
  std::string name;
  double radius = 0;                ///< radius of the finger, m
  std::vector<std::size_t> spaces;  ///< the space of each site
};

/// The surface of a body at rest, and the weights of the configuration spaces on it.
///
/// A vertex near active nodes has weights of up to three spaces:
/// - An active node, or a node of its patch, has weight 1 for its own space. If patches overlap, a
///   node in the overlap has equal weights for all of their spaces.
/// - Another vertex within `reach` of patches has weights for the spaces of the three nearest
///   patches. The weights are (1 / d) (1 - d / reach)^2, scaled to sum 1, where d is the length of
///   the shortest path along surface edges to the patch.
///
/// A triangle is touchable if its three corners have weights. The weights are interpolated linearly
/// in the triangle, so they are continuous over the touchable surface and sum to 1. The force is
/// therefore continuous between active nodes. With only the space of the nearest vertex, as in the
/// paper, the force would jump.
///
/// The area of a finger is touchable in the triangles whose three corners are near its sites and
/// not all fixed. Forces come from the energy of the area. The weights of up to three sites at each
/// vertex only blend the shapes that are displayed.
///
/// Vertices are numbered as in Dataset::surfaceNodes(). Immutable: any thread may read.
class TouchSurface {
 public:
  /// reach: metres. If it is 0, each active node gets a reach of its own: the length of the longest
  /// surface edge at the node, which makes the triangles around it touchable, or the extent of its
  /// patch if that is larger. unsolved: whether sites without a solved point belong to their areas.
  /// Throws Error if no triangle is touchable, or if an area has no site.
  explicit TouchSurface(const Dataset& dataset, double reach = 0, bool unsolved = false);

  const std::vector<Eigen::Vector3d>& vertices() const { return vertices_; }  ///< rest positions, m
  /// Returns the triangles as indices into vertices(), oriented outward.
  const std::vector<Triangle>& triangles() const { return triangles_; }
  /// Returns the unit normals of the vertices, averaged over the faces with their angles as
  /// weights.
  const std::vector<Eigen::Vector3d>& vertexNormals() const { return normals_; }
  const std::vector<TouchArea>& areas() const { return areas_; }
  bool touchable(std::int32_t triangle) const { return !cornerSharesOf(triangle).empty(); }
  /// Returns the triangle across the edge opposite to a corner (0, 1, 2).
  std::int32_t neighbor(std::int32_t triangle, int corner) const {
    return neighbors_[at(triangle)][at(corner)];
  }
  /// Returns the weights of one vertex; empty if the vertex has no weights.
  std::span<const SpaceWeight> sharesOf(std::int32_t vertex) const { return shares_[at(vertex)]; }
  /// Returns the area to which a space belongs as a site, as an index into areas(); -1: none.
  std::int32_t areaOfSpace(std::size_t space) const { return area_of_space_[space]; }
  /// Returns the vertex at the active node of a space; -1 if that node is not a vertex of the
  /// surface.
  std::int32_t activeVertex(std::size_t space) const { return active_vertices_[space]; }
  /// Returns the length of the longest edge at a vertex, m.
  double longestEdgeAt(std::int32_t vertex) const { return longest_edges_[at(vertex)]; }

  // Real time: the following functions do not allocate, lock, throw or log.
  /// Returns the triangles around a vertex, in ascending order.
  std::span<const std::int32_t> trianglesAt(std::int32_t vertex) const noexcept {
    return around_[at(vertex)];
  }
  const Eigen::Vector3d& faceNormal(std::int32_t triangle) const noexcept {
    return faces_[at(triangle)].normal;
  }
  /// Returns the gradients of the barycentric coordinates in the plane of the triangle, 1/m. Column
  /// c belongs to corner c.
  const Eigen::Matrix3d& barycentricGradients(std::int32_t triangle) const noexcept {
    return faces_[at(triangle)].gradients;
  }
  /// Returns the spaces that have a weight at any corner, each once; empty if the triangle is not
  /// touchable.
  std::span<const CornerShares> cornerSharesOf(std::int32_t triangle) const noexcept {
    return corner_shares_[at(triangle)];
  }
  /// Returns the area of a triangle, as an index into areas(); -1 if it is in no area.
  std::int32_t areaOf(std::int32_t triangle) const noexcept { return area_of_[at(triangle)]; }
  Eigen::Vector3d position(const SurfacePoint& point) const noexcept;  ///< position at rest, m
  /// Converts a point on an edge or vertex to the barycentric coordinates of another triangle that
  /// has the same edge or vertex.
  SurfacePoint seenFrom(std::int32_t triangle, const SurfacePoint& point) const noexcept;
  /// Returns the point in a touchable triangle. If its own triangle is not touchable but the point
  /// lies, within rounding, on an edge or vertex of a touchable one, converts it to that triangle.
  /// Otherwise returns the point unchanged.
  SurfacePoint preferTouchable(const SurfacePoint& point) const noexcept;
  /// Returns the unit normal, interpolated between the vertex normals.
  Eigen::Vector3d normal(const SurfacePoint& point) const noexcept;
  /// Returns the weights at a point of a touchable triangle.
  SpaceBlend blendAt(const SurfacePoint& point) const noexcept;
  const SurfaceTree& tree() const noexcept { return tree_; }
  /// Returns the nearest point of the touchable triangles. These triangles are not a closed
  /// surface, so `outside` is meaningless.
  NearestPoint nearestTouchable(const Eigen::Vector3d& point) const noexcept;

 private:
  struct Face {
    Eigen::Vector3d normal;
    Eigen::Matrix3d gradients;
  };
  void setFaces();
  void setNeighbors();
  std::map<std::int32_t, double> distancesFrom(const std::vector<std::int32_t>& sources,
                                               double reach) const;
  void setShares(const std::vector<ActivePatch>& patches, double reach);
  void setAreas(const std::vector<SpaceTable>& spaces, const std::vector<std::int32_t>& fixed);
  void setTouchable();

  std::vector<Eigen::Vector3d> vertices_, normals_;
  std::vector<Triangle> triangles_;
  std::vector<Face> faces_;                             ///< per triangle
  std::vector<std::array<std::int32_t, 3>> neighbors_;  ///< per triangle, by corner; -1: none
  std::vector<std::vector<std::int32_t>> around_;       ///< triangles around each vertex
  std::vector<TouchArea> areas_;
  std::vector<std::int32_t> area_of_;  ///< per triangle
  /// Per vertex, like area_of_. A vertex in an area has weights for the sites of the area only.
  std::vector<std::int32_t> area_of_vertex_;
  std::vector<std::int32_t> area_of_space_;
  std::vector<std::int32_t> active_vertices_;             ///< per space
  std::vector<double> longest_edges_;                     ///< per vertex
  std::vector<std::vector<SpaceWeight>> shares_;          ///< per vertex
  std::vector<std::vector<CornerShares>> corner_shares_;  ///< per triangle; empty if not touchable
  SurfaceTree tree_;
  SurfaceTree touch_tree_;                     ///< contains only the touchable triangles
  std::vector<std::int32_t> touch_triangles_;  ///< indices into triangles() of the triangles of
                                               ///< touch_tree_
};

/// Returns whether the two surfaces have the same triangles and vertices. Real time.
bool sameSurface(const TouchSurface& a, const TouchSurface& b) noexcept;

}  // namespace palpate
