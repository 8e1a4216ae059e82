#pragma once

#include <optional>

#include "viewer/haptics/haptic_tick.hpp"
#include "viewer/picture/mouse_hand.hpp"
#include "viewer/picture/panel_contents.hpp"
#include "viewer/picture/view_control.hpp"

namespace palpate {

/// What mouse and keys do in one picture.
struct PersonsInput {
  MouseMotion motion = {};
  HandInput hand = {};  ///< of the keys; the mouse is in `motion`
};

/// Gives mouse and keys to the hand or to the camera, and tells what is shown of it. Knows no
/// graphics. One thread.
class HandControl {
 public:
  /// One picture of the model in `state`, after which marks() are its. Where the tool is to be;
  /// none: another device moves it.
  std::optional<MouseTarget> apply(const PersonsInput& input, const HapticModel& model,
                                   const HapticState& state, const PictureStatus& status,
                                   OrbitCamera& camera);
  const HandMarks& marks() const { return marks_; }
  /// There is a tool in the scene, which can be drawn.
  bool toolIsThere(const HapticState& state, const PictureStatus& status) const;

 private:
  void moveHand(const PersonsInput& input, const HapticModel& model, ContactMode contact,
                const OrbitCamera& camera);

  ViewControl view_;
  MouseHand hand_;
  HandMarks marks_;
};

}  // namespace palpate
