#pragma once

#include <string>

#include "viewer/haptics/haptic_tick.hpp"
#include "viewer/picture/mouse_hand.hpp"

namespace palpate {

/// Returns a sentence about what the user can do with mouse and keys now. state, contact: of the
/// loop. hand: in this picture.
std::string handHint(const HapticState& state, ContactMode contact, const MouseHand& hand);

/// Returns the hint for a tool that another device moves; empty: none.
std::string deviceHint(const HapticState& state);

}  // namespace palpate
