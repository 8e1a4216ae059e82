#pragma once

#include "viewer/devices/hand_path.hpp"

namespace palpate {

class HapticModel;

/// Speed of a finger that slides over an area while it is pressed in, m/s.
inline constexpr double usual_slide_speed = 0.1;

/// Returns a path on which a hand explores a body for ever. The path depends on the model only.
///
/// At each active node the hand approaches along the outward normal, presses, slides in a circle,
/// retreats, and moves on outside the body. On the area of a finger the hand stays pressed in and
/// slides from site to site at `slide_speed` (m/s, positive) until it has touched all of them.
HandPath touchPath(const HapticModel& model, double slide_speed = usual_slide_speed);

}  // namespace palpate
