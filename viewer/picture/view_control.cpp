#include "viewer/picture/view_control.hpp"

#include <cmath>

namespace palpate {
namespace {

constexpr double turn = 3.5;        ///< radians per height of the view
constexpr double zoom_step = 0.88;  ///< per notch
constexpr double turn_step = 0.08;  ///< radians per stroke

}  // namespace

void ViewControl::apply(const MouseMotion& motion, bool hand, OrbitCamera& camera) {
  const bool held = (motion.left && !hand) || motion.right_button || motion.middle;
  dragging_ = held && (dragging_ || motion.over_view);
  if (dragging_ && (motion.middle || motion.shift))
    camera.pan(motion.right, motion.upward);
  else if (dragging_)
    camera.orbit(-turn * motion.right, -turn * motion.upward);
  camera.orbit(turn_step * motion.turns.x(), turn_step * motion.turns.y());
  const double notches = motion.closer + (motion.over_view && !hand ? motion.wheel : 0);
  if (notches != 0) camera.zoom(std::pow(zoom_step, notches));
}

}  // namespace palpate
