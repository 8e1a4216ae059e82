#pragma once

#include "common/mesh/mesh.hpp"

namespace palpate {

/// A point of a surface: a triangle and barycentric coordinates (>= 0, sum 1).
struct SurfacePoint {
  std::int32_t triangle = -1;  ///< -1: none
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
};

/// Returns the barycentric coordinates of the point of a triangle nearest to `point` (Ericson,
/// Real-Time Collision Detection, 5.1.5). They are exactly zero for corners that are not on the
/// nearest edge or vertex. Real time.
Eigen::Vector3d nearestInTriangle(const std::array<Eigen::Vector3d, 3>& corners,
                                  const Eigen::Vector3d& point) noexcept;

/// Returns `point` (metres). If it is so far away that squared distances would overflow, returns a
/// nearer one in the same direction, with the same nearest point on a body. Real time.
Eigen::Vector3d withinSquares(const Eigen::Vector3d& point) noexcept;

/// Returns the point of the mesh's rest surface nearest to `place` (metres, finite). Checks every
/// triangle; viewer/haptics has a tree for many queries.
SurfacePoint nearestOnSurface(const Mesh& mesh, const Eigen::Vector3d& place);

/// Rest position of a surface point, metres, and the outward unit normal of a triangle.
Eigen::Vector3d positionOf(const Mesh& mesh, const SurfacePoint& point);
Eigen::Vector3d normalOf(const Mesh& mesh, std::int32_t triangle);

/// Returns the part of `vector` tangential to the surface at `place` (metres); a finger cannot
/// leave the surface.
Eigen::Vector3d alongSurface(const Mesh& mesh, const Eigen::Vector3d& place,
                             const Eigen::Vector3d& vector);

}  // namespace palpate
