#pragma once

#include "viewer/devices/hand_path.hpp"

namespace palpate {

class HapticModel;

/// The script of a hand that explores a body: for one active node after the other it approaches
/// along the outward normal, presses, slides in a circle, comes back and goes on outside of the
/// body; over a finger's area it slides, pressed in, from site to site until it has been at all of
/// them; and all of it again, forever. A function of the model alone.
HandPath touchPath(const HapticModel& model);

}  // namespace palpate
