#include "viewer/picture/hand_control.hpp"

#include <algorithm>

#include "common/base/index.hpp"
#include "viewer/picture/hand_hint.hpp"
#include "viewer/picture/tool_shape.hpp"

namespace palpate {
namespace {

constexpr double point_ring = 0.004;  // m, where the tool is a point

/// m, of what the tool presses at a place.
double ringRadius(const HapticModel& model, const SurfacePoint& place) {
  double radius = point_ring;
  for (const CornerShares& share : model.surface().cornerSharesOf(place.triangle))
    radius = std::max(radius, toolOf(model, at(share.space)).radius);
  return radius;
}

bool pressedAnything(const PersonsInput& input) {
  const MouseMotion& motion = input.motion;
  return input.pressed_a_key || motion.left || motion.middle || motion.right_button ||
         motion.wheel != 0;
}

}  // namespace

std::optional<MouseTarget> HandControl::apply(const PersonsInput& input, const HapticModel& model,
                                              const HapticState& state, const PictureStatus& status,
                                              OrbitCamera& camera) {
  if (!status.mouse) {
    marks_ = {.hint = deviceHint(state)};
    view_.apply(input.motion, false, camera);
    return std::nullopt;
  }
  if (tutorial_ && (tutorial_->over() || pressedAnything(input)))
    tutorial_.reset();
  else if (input.wants_tutorial)
    playTutorial();
  MouseMotion motion = input.motion;
  if (tutorial_)
    motion = played(input, model, camera);
  else
    marks_ = {};
  moveHand(input, motion, model, status.contact, camera);
  view_.apply(motion, hand_.holds(), camera);
  if (!tutorial_) marks_.hint = handHint(state, status.contact, hand_);
  return hand_.target();
}

bool HandControl::toolIsThere(const HapticState& state, const PictureStatus& status) const {
  return state.reading.status != DeviceStatus::away &&
         (!status.mouse || hand_.target().position.allFinite());
}

/// What the mouse of the tutorial does.
MouseMotion HandControl::played(const PersonsInput& input, const HapticModel& model,
                                const OrbitCamera& camera) {
  const TutorialGesture gesture = tutorial_->advance(model, camera, input.hand.seconds);
  const Eigen::Vector2d way = gesture.pointer - marks_.cursor.value_or(gesture.pointer);
  marks_ = {.hint = gesture.caption, .cursor = gesture.pointer, .button = gesture.button};
  MouseMotion motion;
  motion.right = way.x();
  motion.upward = way.y();
  motion.wheel = gesture.wheel;
  motion.over_view = true;
  motion.at = gesture.pointer;
  motion.left = gesture.button;
  return motion;
}

void HandControl::moveHand(const PersonsInput& input, const MouseMotion& motion,
                           const HapticModel& model, ContactMode contact,
                           const OrbitCamera& camera) {
  HandInput wanted = input.hand;
  // A drag goes on over panels; of a press by keys there is no drag.
  const bool heard = motion.over_view || (hand_.holds() && !hand_.holdsByKey());
  if (heard) wanted.pointer = motion.at;
  wanted.button = motion.left && heard;
  if (hand_.holds()) wanted.deeper += motion.wheel;
  hand_.update(model, contact, camera, wanted);
  if (hand_.holds() || !hand_.place()) return;
  marks_.ring = hand_.place();
  marks_.ring_radius = ringRadius(model, *marks_.ring);
}

}  // namespace palpate
