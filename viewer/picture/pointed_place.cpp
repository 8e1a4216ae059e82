#include "viewer/picture/pointed_place.hpp"

namespace palpate {
namespace {

PointedPlace placeAt(const TouchSurface& surface, const SurfacePoint& point) {
  return {point, surface.position(point), surface.normal(point), surface.touchable(point.triangle)};
}

}  // namespace

std::optional<PointedPlace> placeUnder(const TouchSurface& surface, const OrbitCamera& camera,
                                       const Eigen::Vector2d& pointer) {
  if (!pointer.allFinite()) return std::nullopt;
  const Eigen::Vector3d eye = camera.position();
  const Crossing seen = surface.tree().entry(eye, eye + camera.far() * camera.ray(pointer));
  if (seen.triangle < 0) return std::nullopt;
  return placeAt(surface, surface.preferTouchable(seen));
}

PointedPlace touchablePlace(const TouchSurface& surface, const Eigen::Vector3d& point) {
  return placeAt(surface, surface.nearestTouchable(point));
}

}  // namespace palpate
