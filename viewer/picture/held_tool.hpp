#pragma once

#include "viewer/haptics/haptic_tick.hpp"
#include "viewer/picture/orbit_camera.hpp"
#include "viewer/picture/soft_light.hpp"
#include "viewer/picture/tool_view.hpp"

namespace palpate {

/// Pose of a tool as a hand would hold it, updated per picture: away from the skin and toward the
/// eye, so that it hides little of the touched place. Independent of the graphics. One thread.
class HeldTool {
 public:
  /// state: of a touch of the model. there: the tool is in the scene; otherwise its pose is not
  /// finite. extent: radius of the body, m.
  void update(const HapticModel& model, const HapticState& state, bool there,
              const OrbitCamera& camera, double extent);

  const ToolPose& pose() const { return pose_; }
  const SkinBelow& skin() const { return skin_; }  ///< while nothing is touched
  /// Returns the shadow of a tool of this radius on the skin below it, or at the contact.
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
