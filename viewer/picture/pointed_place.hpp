#pragma once

#include <Eigen/Core>
#include <optional>

#include "viewer/haptics/touch_surface.hpp"
#include "viewer/picture/orbit_camera.hpp"

namespace palpate {

/// The place of the surface at rest that is under the pointer.
struct PointedPlace : SurfacePoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   ///< outward, unit
  bool touchable = false;
};

/// Returns the first place of the body at rest that is seen at a position on the screen. Returns
/// nullopt if the body is not seen there.
std::optional<PointedPlace> placeUnder(const TouchSurface& surface, const OrbitCamera& camera,
                                       const Eigen::Vector2d& pointer);

/// Returns the touchable place that is nearest to a point (m).
PointedPlace touchablePlace(const TouchSurface& surface, const Eigen::Vector3d& point);

}  // namespace palpate
