#pragma once

#include <algorithm>
#include <cmath>

struct GLFWwindow;

namespace palpate {

/// Rounds the scale of a screen for texts and panels to quarters, 1 to 4. Screens that report a
/// slightly wrong size in millimetres ask for 1.04.
inline double roundedScale(double asked) {
  return std::isfinite(asked) ? std::clamp(std::round(4 * asked) / 4, 1.0, 4.0) : 1;
}

/// Returns the rounded number of window pixels per pixel of a 96 dpi screen.
double screenScale(GLFWwindow* window);
/// Returns window pixels per window unit, the unit of window sizes and mouse positions: 1, or about
/// the screen's scale on systems with scaled units.
double pixelsPerUnit(GLFWwindow* window);

}  // namespace palpate
