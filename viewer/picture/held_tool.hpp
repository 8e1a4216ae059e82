#pragma once

#include "viewer/haptics/haptic_tick.hpp"
#include "viewer/picture/orbit_camera.hpp"
#include "viewer/picture/soft_light.hpp"
#include "viewer/picture/tool_view.hpp"

namespace palpate {

/// From where a tool is to how a hand would hold it, picture by picture: away from the skin, and
/// toward the side of the eye, so that it hides little of what it touches. Knows no graphics. One
/// thread.
class HeldTool {
 public:
  /// state: of a touch of the model. there: the tool is in the scene; else its pose is not finite.
  /// extent: m, radius of the body.
  void update(const HapticModel& model, const HapticState& state, bool there,
              const OrbitCamera& camera, double extent);

  const ToolPose& pose() const { return pose_; }
  const SkinBelow& skin() const { return skin_; }  ///< while nothing is touched
  /// What a tool of this radius throws on the skin below it, or where it touches.
  SoftLight::Shadow shadow(double radius) const;

 private:
  void turnOutward(const Eigen::Vector3d& wanted);

  ToolPose pose_;
  SkinBelow skin_;
  double extent_ = 1;
  bool touching_ = false, known_ = false;
  std::int32_t near_triangle_ = -1;
};

}  // namespace palpate
