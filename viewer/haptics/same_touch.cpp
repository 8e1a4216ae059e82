#include "viewer/haptics/same_touch.hpp"

namespace palpate {

std::optional<Touch> sameTouch(const HapticModel& touched, const Touch& touch,
                               const HapticModel& other, std::size_t method) {
  if (!sameSurface(touched.surface(), other.surface()) || !other.isPrepared(method))
    return std::nullopt;
  Touch same = touch;
  if (!touch.touching) return same;
  if (!other.surface().touchable(touch.anchor.triangle)) return std::nullopt;
  BlendedForce force;
  force.evaluate(other, method, touch.anchor, touch.displacement);
  static_cast<ForceSample&>(same) = force.sum();
  same.blend = force.blend();
  return same;
}

Touch heldTouch(const HapticModel& model, const Hold& hold, const HoldForce& force) {
  const NearestPoint anchor = model.surface().nearestTouchable(hold.place);
  Touch touch;
  touch.touching = true;
  touch.anchor = anchor;
  touch.anchor_position = anchor.position;
  touch.normal = model.surface().normal(anchor);
  touch.displacement = hold.displacement;
  touch.blend = model.surface().blendAt(anchor);
  touch.force = force.force;
  touch.error_bound = force.error_bound;
  return touch;
}

}  // namespace palpate
