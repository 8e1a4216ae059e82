#pragma once

#include "viewer/haptics/haptic_tick.hpp"
#include "viewer/picture/orbit_camera.hpp"
#include "viewer/picture/soft_light.hpp"
#include "viewer/picture/tool_view.hpp"

namespace palpate {

/// Pose of a tool as a hand would hold it: away from the skin and toward the eye, so that it hides
/// little of the touched place. It is updated with every frame. Makes no OpenGL calls. One thread.
class HeldTool {
 public:
  /// state: state of the loop, which touches `model`. there: whether the tool is in the scene; if
  /// not, its pose is not finite. extent: radius of the body, m.
  void update(const HapticModel& model, const HapticState& state, bool there,
              const OrbitCamera& camera, double extent);

  const ToolPose& pose() const { return pose_; }
  const SkinBelow& skin() const { return skin_; }  ///< valid while nothing is touched
  /// Returns the shadow of a tool of this radius. It lies on the skin below the tool, or at the
  /// contact.
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
