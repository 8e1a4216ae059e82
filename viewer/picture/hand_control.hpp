#pragma once

#include <optional>
#include <string>

#include "viewer/haptics/haptic_tick.hpp"
#include "viewer/picture/mouse_hand.hpp"
#include "viewer/picture/panel_contents.hpp"
#include "viewer/picture/view_control.hpp"

namespace palpate {

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
  void moveHand(const PersonsInput& input, const HapticModel& model, ContactMode contact,
                const OrbitCamera& camera);

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
