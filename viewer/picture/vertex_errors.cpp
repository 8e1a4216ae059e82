#include "viewer/picture/vertex_errors.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "common/base/index.hpp"
#include "viewer/haptics/blended_force.hpp"
#include "viewer/picture/lattice_dots.hpp"

namespace palpate {
namespace {

constexpr double half_way = 0.5;  // depth of the press, in radii of the workspace

/// Returns the vertex as a point of a touchable triangle; nullopt if it belongs to no touchable
/// triangle.
std::optional<SurfacePoint> touchablePoint(const TouchSurface& surface, std::int32_t vertex) {
  for (const std::int32_t triangle : surface.trianglesAt(vertex)) {
    if (!surface.touchable(triangle)) continue;
    const auto& [a, b, c] = surface.triangles()[at(triangle)];
    return SurfacePoint{triangle, Eigen::Vector3d(a == vertex, b == vertex, c == vertex)};
  }
  return std::nullopt;
}

/// Returns the workspace radius of the space with the largest weight at a vertex, m.
double radiusAt(const HapticModel& model, std::int32_t vertex) {
  const std::span<const SpaceWeight> shares = model.surface().sharesOf(vertex);
  const auto most = std::ranges::max_element(shares, {}, &SpaceWeight::weight);
  return most == shares.end() ? 0 : model.spaces()[at(most->space)].lattice.radius();
}

}  // namespace

std::vector<double> vertexErrors(const HapticModel& model, std::size_t method) {
  const TouchSurface& surface = model.surface();
  std::vector<double> errors(surface.vertices().size(), std::numeric_limits<double>::quiet_NaN());
  BlendedForce force;
  for (std::size_t v = 0; v < errors.size(); ++v) {
    const auto vertex = static_cast<std::int32_t>(v);
    const std::optional<SurfacePoint> point = touchablePoint(surface, vertex);
    if (!point) continue;
    const double depth = half_way * radiusAt(model, vertex);
    force.evaluate(model, method, *point, -depth * surface.vertexNormals()[v]);
    errors[v] = relativeError(force.sum().error_bound, force.force().norm());
  }
  return errors;
}

}  // namespace palpate
