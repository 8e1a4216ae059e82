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

/// The share of one configuration space in a force.
struct SpaceWeight {
  std::int32_t space = -1;
  double weight = 0;
};

/// Spaces that one vertex blends, and that one triangle does (its corners').
inline constexpr std::size_t most_spaces_of_vertex = 3;
inline constexpr std::size_t most_blended_spaces = 3 * most_spaces_of_vertex;

/// The share of one space in the three corners of a triangle; in between it is interpolated
/// linearly.
struct CornerShares {
  std::int32_t space = -1;
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();
};

/// The shares in a point of the surface; entries 0..size-1 are distinct spaces, their weights sum
/// to 1.
struct SpaceBlend {
  std::array<SpaceWeight, most_blended_spaces> shares;
  std::int32_t size = 0;
};

/// The sites of a finger that share one energy over a part of the surface (AreaField).
struct TouchArea {
  std::string name;
  double radius = 0;                ///< m, of the finger
  std::vector<std::size_t> spaces;  ///< one per site
};

/// The surface of a body at rest, and where on it there are forces to feel.
///
/// Every vertex near active nodes has weights of up to three configuration spaces: an active node,
/// or a node of its patch, 1 of its own (equal parts where patches overlap); another vertex within
/// `reach` (shortest way d along surface edges to the patch) the weights (1 / d) (1 - d / reach)^2
/// of the nearest three, scaled to sum 1. A triangle whose three corners have weights is touchable.
/// In it the weights are interpolated linearly: they are continuous over the touchable surface and
/// sum to 1. So no force jumps where one active node takes over from another, which is what the
/// paper's nearest vertex does.
///
/// A finger's area is touchable where the three corners of a triangle are near its sites. There the
/// forces are those of its energy, and the weights of up to three sites at each vertex only blend
/// the shapes that are seen.
///
/// Vertices are numbered as Dataset::surfaceNodes(). Immutable: any thread may read.
class TouchSurface {
 public:
  /// reach: metres; 0: of each active node the longest surface edge at it (so its ring of triangles
  /// is touchable), and at least its patch's extent. Error when nothing is touchable.
  explicit TouchSurface(const Dataset& dataset, double reach = 0);

  const std::vector<Eigen::Vector3d>& vertices() const { return vertices_; }  ///< rest positions, m
  /// Into vertices(), outward.
  const std::vector<Triangle>& triangles() const { return triangles_; }
  /// Unit, angle-weighted.
  const std::vector<Eigen::Vector3d>& vertexNormals() const { return normals_; }
  const std::vector<TouchArea>& areas() const { return areas_; }
  bool touchable(std::int32_t triangle) const { return !cornerSharesOf(triangle).empty(); }
  /// The triangle beyond the edge opposite to a corner (0, 1, 2).
  std::int32_t neighbor(std::int32_t triangle, int corner) const {
    return neighbors_[at(triangle)][at(corner)];
  }
  /// Shares of one vertex; empty where there is nothing to feel.
  std::span<const SpaceWeight> sharesOf(std::int32_t vertex) const { return shares_[at(vertex)]; }
  /// The vertex of a space's active node; -1: it lies on no vertex of the surface.
  std::int32_t activeVertex(std::size_t space) const { return active_vertices_[space]; }
  /// m, of the edges at a vertex.
  double longestEdgeAt(std::int32_t vertex) const { return longest_edges_[at(vertex)]; }

  // Real time, all of these: they do not allocate, lock, throw or log.
  /// In ascending order.
  std::span<const std::int32_t> trianglesAt(std::int32_t vertex) const noexcept {
    return around_[at(vertex)];
  }
  const Eigen::Vector3d& faceNormal(std::int32_t triangle) const noexcept {
    return faces_[at(triangle)].normal;
  }
  /// 1/m; column c: gradient of the barycentric coordinate of corner c along the triangle.
  const Eigen::Matrix3d& barycentricGradients(std::int32_t triangle) const noexcept {
    return faces_[at(triangle)].gradients;
  }
  /// The spaces with a share in any corner, each once; empty where there is nothing to feel.
  std::span<const CornerShares> cornerSharesOf(std::int32_t triangle) const noexcept {
    return corner_shares_[at(triangle)];
  }
  /// The area that the triangle belongs to, into areas(); -1: none.
  std::int32_t areaOf(std::int32_t triangle) const noexcept { return area_of_[at(triangle)]; }
  Eigen::Vector3d position(const SurfacePoint& point) const noexcept;  ///< at rest, m
  /// unit, vertex normals interpolated
  Eigen::Vector3d normal(const SurfacePoint& point) const noexcept;
  /// Shares at a point of a touchable triangle.
  SpaceBlend blendAt(const SurfacePoint& point) const noexcept;
  const SurfaceTree& tree() const noexcept { return tree_; }
  /// The nearest point of touchable triangles. They are no closed surface: `outside` says nothing
  /// here.
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
  std::vector<std::vector<std::int32_t>> around_;       ///< triangles, per vertex
  std::vector<TouchArea> areas_;
  std::vector<std::int32_t> area_of_;  ///< per triangle
  /// Per vertex: where an area has it, its shares are those of the area's sites.
  std::vector<std::int32_t> area_of_vertex_;
  std::vector<std::int32_t> active_vertices_;             ///< per space
  std::vector<double> longest_edges_;                     ///< per vertex
  std::vector<std::vector<SpaceWeight>> shares_;          ///< per vertex
  std::vector<std::vector<CornerShares>> corner_shares_;  ///< per triangle; none: not touchable
  SurfaceTree tree_;
  SurfaceTree touch_tree_;                     ///< of the touchable triangles
  std::vector<std::int32_t> touch_triangles_;  ///< their numbers
};

/// The same triangles, vertex for vertex. Real time.
bool sameSurface(const TouchSurface& a, const TouchSurface& b) noexcept;

}  // namespace palpate
