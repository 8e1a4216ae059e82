#pragma once

#include <Eigen/Core>
#include <optional>

#include "viewer/haptics/touch_surface.hpp"
#include "viewer/picture/orbit_camera.hpp"

namespace palpate {

/// A place of the surface at rest that a pointer shows.
struct PointedPlace : SurfacePoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   ///< outward, unit
  bool touchable = false;
};

/// What is seen first of the body at rest, at a place on the screen; none: nothing of it.
std::optional<PointedPlace> placeUnder(const TouchSurface& surface, const OrbitCamera& camera,
                                       const Eigen::Vector2d& pointer);

/// The touchable place nearest to a point, m.
PointedPlace touchablePlace(const TouchSurface& surface, const Eigen::Vector3d& point);

}  // namespace palpate
