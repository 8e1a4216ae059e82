#pragma once

#include "viewer/devices/hand_path.hpp"

namespace palpate {

class HapticModel;

/// Returns a path on which a hand explores a body for ever. The path depends on the model only.
///
/// At each active node the hand approaches along the outward normal, presses, slides in a circle,
/// retreats, and moves on outside the body. On the area of a finger the hand stays pressed in and
/// slides from site to site until it has touched all of them.
HandPath touchPath(const HapticModel& model);

}  // namespace palpate
