#pragma once

#include <array>
#include <span>

namespace palpate {

/// Interpolates between at least two colours (0xRRGGBB) at even distances on a scale. Returns red,
/// green and blue, 0 to 255. place: position on the scale, 0 to 1; other values are clamped, and
/// NaN is treated as 0.
std::array<double, 3> colourAmong(std::span<const int> colours, double place);

/// Returns a colour of Viridis (van der Walt, Smith; CC0) as red, green and blue, 0 to 255.
///
/// The colours run from dark blue over green to yellow, and their lightness increases in even
/// steps. They are therefore readable in grey prints and by colour-blind people. place: as for
/// colourAmong().
std::array<double, 3> viridis(double place);

}  // namespace palpate
