#pragma once

#include <string>

#include "viewer/haptics/haptic_tick.hpp"
#include "viewer/picture/mouse_hand.hpp"

namespace palpate {

/// What the person at mouse and keys can do now, in a sentence. state: of the loop, whose contact
/// is as told. hand: as of this picture.
std::string handHint(const HapticState& state, ContactMode contact, const MouseHand& hand);

/// The same where another device moves the tool; empty: nothing.
std::string deviceHint(const HapticState& state);

}  // namespace palpate
