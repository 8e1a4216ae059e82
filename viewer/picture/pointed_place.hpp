#pragma once

#include <Eigen/Core>
#include <optional>

#include "viewer/haptics/touch_surface.hpp"
#include "viewer/picture/orbit_camera.hpp"

namespace palpate {

/// A place on the surface at rest under the pointer.
struct PointedPlace : SurfacePoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   ///< outward, unit
  bool touchable = false;
};

/// Returns the first place of the body at rest seen at a place on the screen; empty: the body is
/// not there.
std::optional<PointedPlace> placeUnder(const TouchSurface& surface, const OrbitCamera& camera,
                                       const Eigen::Vector2d& pointer);

/// Returns the touchable place nearest to a point, m.
PointedPlace touchablePlace(const TouchSurface& surface, const Eigen::Vector3d& point);

}  // namespace palpate
