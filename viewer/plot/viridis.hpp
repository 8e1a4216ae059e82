#pragma once

#include <array>

namespace palpate {

/// Returns a colour of Viridis (van der Walt, Smith; CC0) as red, green, blue, 0 to 255.
///
/// It runs from dark blue over green to yellow with even lightness steps, readable in grey prints
/// and by colour-blind people. place: 0 to 1; clamped, NaN as 0.
std::array<double, 3> viridis(double place);

}  // namespace palpate
