#pragma once

namespace palpate {

// Pace of a hand without a device, shared by the window of `palpate view`
// (viewer/picture/mouse_hand.hpp) and the pages of `palpate share` (viewer/share).

/// Rates at which the depth approaches its target, 1/s. A hand releases faster than it presses.
inline constexpr double press_rate = 9, release_rate = 16;
/// Initial target depth: usual_depth (m), or usual_share of the reach (the workspace radius) if
/// that is less.
inline constexpr double usual_depth = 0.01;
inline constexpr double usual_share = 0.4;

}  // namespace palpate
