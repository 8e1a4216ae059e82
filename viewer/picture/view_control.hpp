#pragma once

#include <Eigen/Core>
#include <limits>

#include "viewer/picture/orbit_camera.hpp"

namespace palpate {

/// Input for the camera by mouse and keys since the last frame. Lengths are in heights of the view,
/// y upward.
struct MouseMotion {
  double right = 0, upward = 0;  ///< distance that the mouse moved
  double wheel = 0;              ///< notches, positive away from the user
  bool over_view = false;        ///< the pointer is over the view, not over a panel
  /// Position of the pointer, (0, 0) at the middle of the view; not finite if it is outside the
  /// window.
  Eigen::Vector2d at = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  bool left = false, middle = false, right_button = false;  ///< buttons that are held down
  bool shift = false;
  /// Strokes of the keys that turn the view, to the right and upward, and of the key that zooms in.
  Eigen::Vector2d turns = Eigen::Vector2d::Zero();
  double closer = 0;
};

/// Turns the input into moves of the camera. One thread.
class ViewControl {
 public:
  /// Moves the camera. hand: whether left button and wheel belong to the hand (MouseHand), not to
  /// the camera.
  void apply(const MouseMotion& motion, bool hand, OrbitCamera& camera);

 private:
  bool dragging_ = false;  ///< a drag that began in the view continues outside of it
};

}  // namespace palpate
