#pragma once

namespace palpate {

// Pace of a simulated hand, which needs no device. The window of `palpate view`
// (viewer/picture/mouse_hand.hpp) and the pages of `palpate share` (viewer/share) use it.

/// Rates at which the depth of the tool approaches its target, 1/s. A hand releases faster than it
/// presses.
inline constexpr double press_rate = 9, release_rate = 16;
/// Target depth at the start: usual_depth (m), but at most the fraction usual_share of the
/// workspace radius.
inline constexpr double usual_depth = 0.01;
inline constexpr double usual_share = 0.4;

}  // namespace palpate
