#pragma once

#include "common/mesh/mesh.hpp"

namespace palpate {

/// A point of a surface: a triangle and barycentric coordinates of its corners (>= 0, sum 1).
struct SurfacePoint {
  std::int32_t triangle = -1;  ///< -1: none
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
};

/// Barycentric coordinates of the point of a triangle that is nearest to `point` (Ericson,
/// Real-Time Collision Detection, 5.1.5). Exactly zero for corners that the nearest edge or vertex
/// does not have. Real time.
Eigen::Vector3d nearestInTriangle(const std::array<Eigen::Vector3d, 3>& corners,
                                  const Eigen::Vector3d& point) noexcept;

/// A finite point, metres; instead of one that is farther away than squares of numbers reach, one
/// in its direction to which the same of a body is nearest. Real time.
Eigen::Vector3d withinSquares(const Eigen::Vector3d& point) noexcept;

/// The point of the mesh's surface at rest that is nearest to `place` (metres, finite). Looks at
/// every triangle: a tree for many queries is in viewer/haptics.
SurfacePoint nearestOnSurface(const Mesh& mesh, const Eigen::Vector3d& place);

/// Where a point of the surface is at rest, metres, and the outward unit normal of its triangle.
Eigen::Vector3d positionOf(const Mesh& mesh, const SurfacePoint& point);
Eigen::Vector3d normalOf(const Mesh& mesh, std::int32_t triangle);

/// What of a vector lies in the surface at a place on it, metres: a finger cannot leave it.
Eigen::Vector3d alongSurface(const Mesh& mesh, const Eigen::Vector3d& place,
                             const Eigen::Vector3d& vector);

}  // namespace palpate
