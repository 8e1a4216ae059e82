#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/dataset.hpp"
#include "viewer/haptics/surface_tree.hpp"

namespace palpate {

/// A point of the surface: a triangle and barycentric coordinates of its corners (>= 0, sum 1).
struct SurfacePoint {
  std::int32_t triangle = -1;  ///< -1: none
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
};

/// The share of one configuration space in a force.
struct SpaceWeight {
  std::int32_t space = -1;
  double weight = 0;
};

/// Spaces that one vertex blends, and that one triangle does (its corners').
inline constexpr std::size_t most_spaces_of_vertex = 3;
inline constexpr std::size_t most_blended_spaces = 3 * most_spaces_of_vertex;

/// The shares in a point of the surface; entries 0..size-1 are distinct spaces, their weights sum to 1.
struct SpaceBlend {
  std::array<SpaceWeight, most_blended_spaces> shares;
  std::int32_t size = 0;
};

/// The surface of a body at rest, and where on it there are forces to feel.
///
/// Every vertex near active nodes has weights of up to three configuration spaces: an active node, or a node
/// of its patch, 1 of its own; another vertex within `reach` (shortest way along surface edges) of active
/// nodes the inverse-distance weights of the nearest three, tapered to zero at the reach. A triangle whose
/// three corners have weights is touchable. In it the weights are interpolated linearly: they are continuous
/// over the touchable surface and sum to 1. So no force jumps where one active node takes over from another,
/// which is what the paper's nearest vertex does.
///
/// Vertices are numbered as Dataset::surfaceNodes(). Immutable: any thread may read.
class TouchSurface {
 public:
  /// reach: metres; 0: of each active node the longest surface edge at it (so its ring of triangles is
  /// touchable), and at least its patch's extent. Error when nothing is touchable.
  explicit TouchSurface(const Dataset& dataset, double reach = 0);

  const std::vector<Eigen::Vector3d>& vertices() const { return vertices_; }  ///< rest positions, m
  const std::vector<Triangle>& triangles() const { return triangles_; }       ///< into vertices(), outward
  const std::vector<Eigen::Vector3d>& vertexNormals() const { return normals_; }  ///< unit, angle-weighted
  bool touchable(std::int32_t triangle) const { return touchable_[static_cast<std::size_t>(triangle)]; }
  /// The triangle beyond the edge opposite to a corner (0, 1, 2).
  std::int32_t neighbor(std::int32_t triangle, int corner) const;
  /// Shares of one vertex; empty where there is nothing to feel.
  std::span<const SpaceWeight> sharesOf(std::int32_t vertex) const;

  // Real time, all of these: they do not allocate, lock, throw or log.
  Eigen::Vector3d position(const SurfacePoint& point) const noexcept;  ///< at rest, m
  Eigen::Vector3d normal(const SurfacePoint& point) const noexcept;    ///< unit, vertex normals interpolated
  /// Shares at a point of a touchable triangle.
  SpaceBlend blendAt(const SurfacePoint& point) const noexcept;
  const SurfaceTree& tree() const noexcept { return tree_; }

 private:
  void setNormals();
  void setNeighbors();
  void setShares(const Dataset& dataset, double reach);

  std::vector<Eigen::Vector3d> vertices_, normals_;
  std::vector<Triangle> triangles_;
  std::vector<std::array<std::int32_t, 3>> neighbors_;
  std::vector<std::array<SpaceWeight, most_spaces_of_vertex>> shares_;
  std::vector<std::int32_t> share_counts_;
  std::vector<bool> touchable_;
  SurfaceTree tree_;
};

}  // namespace palpate
