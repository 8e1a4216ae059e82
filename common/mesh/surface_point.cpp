#include "common/mesh/surface_point.hpp"

#include <limits>

#include "common/base/assertion.hpp"

namespace palpate {

Eigen::Vector3d nearestInTriangle(const std::array<Eigen::Vector3d, 3>& corners,
                                  const Eigen::Vector3d& point) noexcept {
  const Eigen::Vector3d ab = corners[1] - corners[0], ac = corners[2] - corners[0];
  const Eigen::Vector3d ap = point - corners[0], bp = point - corners[1], cp = point - corners[2];
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp),
               d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

Eigen::Vector3d withinSquares(const Eigen::Vector3d& point) noexcept {
  constexpr double far = 1e9;  // m; a body is negligibly small at this distance
  const double largest = point.cwiseAbs().maxCoeff();
  return largest > far ? Eigen::Vector3d(point / largest * far) : point;
}

SurfacePoint nearestOnSurface(const Mesh& mesh, const Eigen::Vector3d& place) {
  PALPATE_ASSERT(place.allFinite() && !mesh.surface.empty(), "place and surface must be valid");
  const Eigen::Vector3d point = withinSquares(place);
  SurfacePoint nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::int32_t triangle = 0; at(triangle) < mesh.surface.size(); ++triangle) {
    const auto corners = cornersOf(mesh.nodes, mesh.surface[triangle]);
    const Eigen::Vector3d barycentric = nearestInTriangle(corners, point);
    const double distance = (combined(corners, barycentric) - point).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    nearest = {triangle, barycentric};
  }
  PALPATE_ASSERT(nearest.triangle >= 0, "the nearest point must lie on a triangle");
  return nearest;
}

Eigen::Vector3d positionOf(const Mesh& mesh, const SurfacePoint& point) {
  return combined(cornersOf(mesh.nodes, mesh.surface[point.triangle]), point.barycentric);
}

Eigen::Vector3d alongSurface(const Mesh& mesh, const Eigen::Vector3d& place,
                             const Eigen::Vector3d& vector) {
  const Eigen::Vector3d normal = normalOf(mesh, nearestOnSurface(mesh, place).triangle);
  return vector - normal.dot(vector) * normal;
}

Eigen::Vector3d normalOf(const Mesh& mesh, std::int32_t triangle) {
  const auto [a, b, c] = cornersOf(mesh.nodes, mesh.surface[triangle]);
  return (b - a).cross(c - a).normalized();
}

}  // namespace palpate
