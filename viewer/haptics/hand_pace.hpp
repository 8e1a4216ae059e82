#pragma once

namespace palpate {

// How a hand without a device presses, alike in the window of `palpate view`
// (viewer/picture/mouse_hand.hpp) and in the pages of `palpate share` (viewer/share).

/// Of the depth, 1/s: it nears the wanted one at this rate, and a hand lets go faster than it
/// presses.
inline constexpr double press_rate = 9, release_rate = 16;
/// m, what is wanted first, or less where less was computed:
inline constexpr double usual_depth = 0.01;
/// of the reach (the radius of the workspace).
inline constexpr double usual_share = 0.4;

}  // namespace palpate
