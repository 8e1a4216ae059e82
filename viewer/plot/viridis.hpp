#pragma once

#include <array>

namespace palpate {

/// Viridis (van der Walt, Smith; CC0): from dark blue over green to yellow, growing lighter evenly,
/// read by colour-blind people and in grey prints. place: 0 to 1, beyond it the nearest, NaN as 0.
/// Red, green, blue, 0 to 255.
std::array<double, 3> viridis(double place);

}  // namespace palpate
