#pragma once

#include "common/base/index.hpp"
#include "common/mesh/mesh.hpp"

namespace palpate {

/// A point of a surface: a triangle and barycentric coordinates (>= 0, sum 1).
struct SurfacePoint {
  std::int32_t triangle = -1;  ///< -1: none
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
};

/// Returns the values of `vertices` at the corners of triangle `t`. Real time.
inline std::array<Eigen::Vector3d, 3> cornersOf(const std::vector<Eigen::Vector3d>& vertices,
                                                const Triangle& t) noexcept {
  return {vertices[at(t[0])], vertices[at(t[1])], vertices[at(t[2])]};
}
/// Returns the sum of the corners, each times its barycentric coordinate. Real time.
inline Eigen::Vector3d combined(const std::array<Eigen::Vector3d, 3>& corners,
                                const Eigen::Vector3d& barycentric) noexcept {
  return barycentric[0] * corners[0] + barycentric[1] * corners[1] + barycentric[2] * corners[2];
}

/// Returns the barycentric coordinates of the point of a triangle that is nearest to `point`
/// (Ericson, Real-Time Collision Detection, 5.1.5). If that point lies on an edge or corner, the
/// coordinates of the other corners are exactly zero. Real time.
Eigen::Vector3d nearestInTriangle(const std::array<Eigen::Vector3d, 3>& corners,
                                  const Eigen::Vector3d& point) noexcept;

/// Returns `point` (metres), or, if it is so far away that squared distances could overflow, a
/// nearer point in the same direction. The nearest point of a body is the same for both. Real time.
Eigen::Vector3d withinSquares(const Eigen::Vector3d& point) noexcept;

/// Returns the point of the mesh's rest surface that is nearest to `place` (metres, finite). Checks
/// every triangle. For many queries use the tree in viewer/haptics.
SurfacePoint nearestOnSurface(const Mesh& mesh, const Eigen::Vector3d& place);

/// Return the rest position of a surface point, metres, and a triangle's outward unit normal.
Eigen::Vector3d positionOf(const Mesh& mesh, const SurfacePoint& point);
Eigen::Vector3d normalOf(const Mesh& mesh, std::int32_t triangle);

/// Returns the component of `vector` that is tangential to the surface at the surface point nearest
/// to `place` (metres). Only this component can move a finger, which cannot leave the surface.
Eigen::Vector3d alongSurface(const Mesh& mesh, const Eigen::Vector3d& place,
                             const Eigen::Vector3d& vector);

}  // namespace palpate
