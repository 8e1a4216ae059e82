#pragma once

#include <algorithm>
#include <cmath>

struct GLFWwindow;

namespace palpate {

/// Rounds the scale of texts and panels to a multiple of 0.25, from 1 to 4. Some screens report a
/// slightly wrong size in millimetres and would get a scale such as 1.04.
inline double roundedScale(double asked) {
  return std::isfinite(asked) ? std::clamp(std::round(4 * asked) / 4, 1.0, 4.0) : 1;
}

/// Returns the number of window pixels per pixel of a 96 dpi screen, rounded (roundedScale).
double screenScale(GLFWwindow* window);
/// Returns the number of window pixels per window unit. Window sizes and mouse positions are in
/// this unit. The number is 1, or about the screen's scale on systems with scaled units.
double pixelsPerUnit(GLFWwindow* window);

}  // namespace palpate
