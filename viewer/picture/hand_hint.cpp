#include "viewer/picture/hand_hint.hpp"

namespace palpate {
namespace {

/// Returns whether the tool is inside the body without contact. It entered a part that is not
/// touchable, or was released inside.
bool feelsNothingInside(const HapticState& state) {
  return !state.touch.touching && state.touch.gap < 0 &&
         state.reading.status != DeviceStatus::away && state.reading.status != DeviceStatus::lost;
}

/// Returns the hint while keys move the ring or press; a hint about the mouse button would be wrong
/// then.
const char* keysHint(bool glued, bool holds) {
  if (!holds)
    return glued ? "Enter grips here, arrows move the ring."
                 : "Enter presses here, arrows move the ring.";
  return glued ? "Arrows pull, Page Down presses, Enter lets go."
               : "Arrows slide, Page Down presses deeper, Enter ends.";
}

}  // namespace

std::string handHint(const HapticState& state, ContactMode contact, const MouseHand& hand) {
  if (feelsNothingInside(state)) return "The tool is inside the organ: press R to take it out.";
  const bool glued = contact == ContactMode::glued;
  if (hand.placedByKeys() && hand.place()) return keysHint(glued, hand.holds());
  if (hand.holds() && glued) return "Move to pull, turn the wheel to press, let go to release.";
  if (hand.holds()) return "Move to slide, turn the wheel to press deeper, let go to end.";
  if (hand.place()) return "Hold the left button to press.";
  if (hand.seen()) return "Nothing was computed here: press where the skin is tinted.";
  return "Press the organ with the mouse. Drag beside it to turn, wheel to zoom. H: all keys.";
}

std::string deviceHint(const HapticState& state) {
  if (feelsNothingInside(state)) return "The tool is inside the organ. Move it out to feel again.";
  return "";
}

}  // namespace palpate
