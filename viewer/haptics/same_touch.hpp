#pragma once

#include <optional>

#include "viewer/haptics/contact.hpp"

namespace palpate {

/// What another dataset answers in a touch: at the same place of the surface and the same
/// displacement, by its own forces and spaces. None where it cannot answer: it is of another body
/// (surfaces differ in a triangle or a vertex), nothing was computed there, or the method is not
/// prepared. Any thread; not real time.
std::optional<Touch> sameTouch(const HapticModel& touched, const Touch& touch,
                               const HapticModel& other, std::size_t method);

}  // namespace palpate
