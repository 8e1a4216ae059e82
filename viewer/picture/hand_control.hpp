#pragma once

#include <limits>
#include <optional>
#include <string>

#include "viewer/haptics/haptic_tick.hpp"
#include "viewer/picture/mouse_hand.hpp"
#include "viewer/picture/orbit_camera.hpp"
#include "viewer/picture/panel_contents.hpp"

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

/// Input by mouse and keys for one frame.
struct PersonsInput {
  MouseMotion motion = {};
  HandInput hand = {};  ///< only the input by keys; that of the mouse is in `motion`
};

/// Passes the input by mouse and keys to the hand or to the camera, and provides the marks to show.
/// Makes no OpenGL calls. One thread.
class HandControl {
 public:
  /// Handles the input of one frame for the model in `state`, and updates marks(). Returns the
  /// target of the tool; nullopt if another device moves the tool.
  std::optional<MouseTarget> apply(const PersonsInput& input, const HapticModel& model,
                                   const HapticState& state, const PictureStatus& status,
                                   OrbitCamera& camera);
  const HandMarks& marks() const { return marks_; }
  /// Returns whether the scene contains a tool to draw.
  bool toolIsThere(const HapticState& state, const PictureStatus& status) const;

 private:
  ViewControl view_;
  MouseHand hand_;
  HandMarks marks_;
};

/// Returns a sentence that tells the user what mouse and keys can do now. state, contact: state and
/// contact mode of the loop. hand: already updated for this frame.
std::string handHint(const HapticState& state, ContactMode contact, const MouseHand& hand);

/// Returns the hint for a tool that another device moves; empty if there is nothing to say.
std::string deviceHint(const HapticState& state);

}  // namespace palpate
