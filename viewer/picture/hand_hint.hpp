#pragma once

#include <string>

#include "viewer/haptics/haptic_tick.hpp"
#include "viewer/picture/mouse_hand.hpp"

namespace palpate {

/// Returns a sentence that tells the user what mouse and keys can do now. state, contact: state and
/// contact mode of the loop. hand: already updated for this frame.
std::string handHint(const HapticState& state, ContactMode contact, const MouseHand& hand);

/// Returns the hint for a tool that another device moves; empty if there is nothing to say.
std::string deviceHint(const HapticState& state);

}  // namespace palpate
