#pragma once

#include <optional>

#include "viewer/haptics/contact.hpp"
#include "viewer/haptics/live_touch.hpp"

namespace palpate {

/// Returns the touch at the same surface point and displacement in another dataset, computed from
/// that dataset's spaces. Returns nullopt if the surfaces of the two bodies differ in a triangle or
/// vertex, the point is not touchable there, or the method is not prepared. Any thread; not real
/// time.
std::optional<Touch> sameTouch(const HapticModel& touched, const Touch& touch,
                               const HapticModel& other, std::size_t method);

/// Returns the touch of a second finger that holds this model.
Touch heldTouch(const HapticModel& model, const Hold& hold, const HoldForce& force);

}  // namespace palpate
