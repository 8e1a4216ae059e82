#include "viewer/picture/view_control.hpp"

#include <cmath>

namespace palpate {
namespace {

constexpr double turn = 3.5;         ///< radians per height of the view
constexpr double zoom_step = 0.88;   ///< per notch
constexpr double depth_step = 0.02;  ///< of the radius of the scene, per notch

}  // namespace

std::optional<Eigen::Vector3d> ViewControl::apply(const MouseMotion& motion,
                                                  const Eigen::Vector3d& tool,
                                                  const FramedSphere& scene, OrbitCamera& camera) {
  if (!motion.control) {
    target_.reset();
    moveCamera(motion, camera);
    return std::nullopt;
  }
  dragging_ = false;
  if (!target_)
    target_ = tool.allFinite() ? tool : scene.centre;
  else
    moveTool(motion, scene, camera);
  return target_;
}

void ViewControl::moveCamera(const MouseMotion& motion, OrbitCamera& camera) {
  const bool held = motion.left || motion.other;
  dragging_ = held && (dragging_ || motion.over_view);
  if (dragging_ && (motion.other || motion.shift))
    camera.pan(motion.right, motion.upward);
  else if (dragging_)
    camera.orbit(-turn * motion.right, -turn * motion.upward);
  if (motion.over_view && motion.wheel != 0) camera.zoom(std::pow(zoom_step, motion.wheel));
}

void ViewControl::moveTool(const MouseMotion& motion, const FramedSphere& scene,
                           const OrbitCamera& camera) {
  *target_ += camera.moveInPlane(*target_, motion.right, motion.upward);
  *target_ -= depth_step * scene.radius * motion.wheel * camera.axes().col(2);
}

}  // namespace palpate
