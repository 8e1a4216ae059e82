#pragma once

#include "viewer/devices/hand_path.hpp"

namespace palpate {

class HapticModel;

/// Returns a path that explores a body for ever, and depends on the model alone. At each active
/// node it approaches along the outward normal, presses, slides in a circle, retreats, and moves on
/// outside the body. On a finger's area it slides from site to site, pressed in, until it has
/// touched all of them.
HandPath touchPath(const HapticModel& model);

}  // namespace palpate
