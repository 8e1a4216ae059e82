#include "viewer/picture/hand_control.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/index.hpp"
#include "viewer/picture/tool_view.hpp"

namespace palpate {
namespace {

constexpr double turn = 3.5;        ///< radians per height of the view
constexpr double zoom_step = 0.88;  ///< per notch
constexpr double turn_step = 0.08;  ///< radians per stroke

constexpr double point_ring = 0.004;  // m, radius of the ring if the tool is a point

/// Returns the radius of the ring for the tool at a place, m.
double ringRadius(const HapticModel& model, const SurfacePoint& place) {
  double radius = point_ring;
  for (const CornerShares& share : model.surface().cornerSharesOf(place.triangle))
    radius = std::max(radius, toolOf(model, at(share.space)).radius);
  return radius;
}

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

std::optional<MouseTarget> HandControl::apply(const PersonsInput& input, const HapticModel& model,
                                              const HapticState& state, const PictureStatus& status,
                                              OrbitCamera& camera) {
  if (!status.mouse) {
    marks_ = {.hint = deviceHint(state)};
    view_.apply(input.motion, false, camera);
    return std::nullopt;
  }
  HandInput wanted = input.hand;
  // A drag that began in the view continues over panels. A press by keys has no drag.
  const bool heard = input.motion.over_view || (hand_.holds() && !hand_.holdsByKey());
  if (heard) wanted.pointer = input.motion.at;
  wanted.button = input.motion.left && heard;
  if (hand_.holds()) wanted.deeper += input.motion.wheel;
  hand_.update(model, status.contact, camera, wanted);
  view_.apply(input.motion, hand_.holds(), camera);
  marks_ = {.hint = handHint(state, status.contact, hand_)};
  if (!hand_.holds() && hand_.place()) {
    marks_.ring = hand_.place();
    marks_.ring_radius = ringRadius(model, *marks_.ring);
  }
  return hand_.target();
}

bool HandControl::toolIsThere(const HapticState& state, const PictureStatus& status) const {
  return state.reading.status != DeviceStatus::away &&
         (!status.mouse || hand_.target().position.allFinite());
}

}  // namespace palpate
