#pragma once

#include <Eigen/Core>
#include <limits>

#include "viewer/picture/orbit_camera.hpp"

namespace palpate {

/// Input for the camera by mouse and keys since the last picture. Lengths in heights of the view, y
/// upward.
struct MouseMotion {
  double right = 0, upward = 0;  ///< distance moved
  double wheel = 0;              ///< notches, > 0: away from the user
  bool over_view = false;        ///< not over a panel
  /// Position, (0, 0) at the middle of the view; not finite: outside the window.
  Eigen::Vector2d at = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  bool left = false, middle = false, right_button = false;  ///< buttons held
  bool shift = false;
  /// Strokes of the keys that turn, to the right and upward, and that zoom in.
  Eigen::Vector2d turns = Eigen::Vector2d::Zero();
  double closer = 0;
};

/// Turns input into camera moves. One thread.
class ViewControl {
 public:
  /// hand: left button and wheel belong to the hand (MouseHand), not to the camera.
  void apply(const MouseMotion& motion, bool hand, OrbitCamera& camera);

 private:
  bool dragging_ = false;  ///< a drag that began in the view continues outside it
};

}  // namespace palpate
