#pragma once

#include <optional>

#include "viewer/haptics/contact.hpp"

namespace palpate {

/// Returns the touch that another dataset gives at the same surface point and displacement, from
/// its own forces and spaces. Empty if the other body's surface differs in a triangle or vertex,
/// the point is not touchable there, or the method is not prepared. Any thread; not real time.
std::optional<Touch> sameTouch(const HapticModel& touched, const Touch& touch,
                               const HapticModel& other, std::size_t method);

}  // namespace palpate
