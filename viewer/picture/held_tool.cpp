#include "viewer/picture/held_tool.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace palpate {
namespace {

constexpr double turned_per_frame = 0.2;  // fraction of the remaining turn that is made in one
                                          // frame, so that the tool does not jump
constexpr double high = 0.5;  // height in radii of the body; a tool this high casts no shadow
constexpr double darkest = 0.45;
constexpr double contact_reach = 1.7;  // radius of the shadow at the contact, in radii of the tool

}  // namespace

void HeldTool::update(const HapticModel& model, const HapticState& state, bool there,
                      const OrbitCamera& camera, double extent) {
  extent_ = extent;
  touching_ = state.touch.touching;
  pose_.tip = there ? state.shownTool() : nowhere();
  if (!pose_.tip.allFinite()) return;
  const NearestPoint nearest = model.surface().tree().nearest(
      pose_.tip, near_triangle_ < std::ssize(model.surface().triangles()) ? near_triangle_ : -1);
  near_triangle_ = nearest.triangle;
  skin_ = {nearest.position, nearest.outside ? nearest.distance : 0};
  if (touching_)
    turnOutward(state.touch.normal);
  else if (nearest.outside && nearest.distance > 0)
    turnOutward((pose_.tip - nearest.position) / nearest.distance);
  const Eigen::Matrix3d axes = camera.axes();
  pose_.handle =
      (pose_.outward + 0.55 * axes.col(0) + 0.45 * axes.col(1) + 0.25 * axes.col(2)).normalized();
}

void HeldTool::turnOutward(const Eigen::Vector3d& wanted) {
  const double share = known_ ? turned_per_frame : 1;
  known_ = true;
  pose_.outward = (pose_.outward + share * (wanted - pose_.outward)).normalized();
}

SoftLight::Shadow HeldTool::shadow(double radius) const {
  if (!pose_.tip.allFinite()) return {};
  if (touching_) return {pose_.tip, contact_reach * radius, darkest};
  const double left = std::clamp(1 - skin_.gap / (high * extent_), 0.0, 1.0);
  return {skin_.place, contact_reach * radius + skin_.gap, darkest * left};
}

}  // namespace palpate
