#pragma once

#include <Eigen/Core>
#include <limits>

#include "viewer/picture/orbit_camera.hpp"

namespace palpate {

/// What mouse and keys ask of the camera since the last picture; lengths in heights of the view, y
/// upward.
struct MouseMotion {
  double right = 0, upward = 0;  ///< how far it moved
  double wheel = 0;              ///< notches, > 0: away from the person
  bool over_view = false;        ///< not over a panel
  /// Where it is, (0, 0) the middle of the view; not finite: outside of the window.
  Eigen::Vector2d at = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  bool left = false, middle = false, right_button = false;  ///< buttons that are held
  bool shift = false;
  /// Strokes of keys that turn, to the right and upward, and that come closer.
  Eigen::Vector2d turns = Eigen::Vector2d::Zero();
  double closer = 0;
};

/// Turns motion into camera moves. One thread.
class ViewControl {
 public:
  /// hand: the left button and the wheel are the hand's (MouseHand), not the camera's.
  void apply(const MouseMotion& motion, bool hand, OrbitCamera& camera);

 private:
  bool dragging_ = false;  ///< a drag that began in the view goes on beyond it
};

}  // namespace palpate
