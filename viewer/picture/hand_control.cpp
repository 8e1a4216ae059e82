#include "viewer/picture/hand_control.hpp"

#include <algorithm>

#include "common/base/index.hpp"
#include "viewer/picture/hand_hint.hpp"
#include "viewer/picture/tool_shape.hpp"

namespace palpate {
namespace {

constexpr double point_ring = 0.004;  // m, radius of the ring if the tool is a point

/// Returns the radius of the ring for the tool at a place, m.
double ringRadius(const HapticModel& model, const SurfacePoint& place) {
  double radius = point_ring;
  for (const CornerShares& share : model.surface().cornerSharesOf(place.triangle))
    radius = std::max(radius, toolOf(model, at(share.space)).radius);
  return radius;
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
  marks_ = {};
  moveHand(input, model, status.contact, camera);
  view_.apply(input.motion, hand_.holds(), camera);
  marks_.hint = handHint(state, status.contact, hand_);
  return hand_.target();
}

bool HandControl::toolIsThere(const HapticState& state, const PictureStatus& status) const {
  return state.reading.status != DeviceStatus::away &&
         (!status.mouse || hand_.target().position.allFinite());
}

void HandControl::moveHand(const PersonsInput& input, const HapticModel& model, ContactMode contact,
                           const OrbitCamera& camera) {
  const MouseMotion& motion = input.motion;
  HandInput wanted = input.hand;
  // A drag that began in the view continues over panels. A press by keys has no drag.
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
