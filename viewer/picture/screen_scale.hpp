#pragma once

#include <algorithm>
#include <cmath>

struct GLFWwindow;

namespace palpate {

/// The scale of texts and panels for what a screen asks for: quarters, 1 to 4. Screens that tell
/// their size in millimetres wrongly ask for 1.04.
inline double roundedScale(double asked) {
  return std::isfinite(asked) ? std::clamp(std::round(4 * asked) / 4, 1.0, 4.0) : 1;
}

/// Pixels of a window for each pixel of a screen of 96 dots per inch, rounded.
double screenScale(GLFWwindow* window);
/// Pixels of a window for each of its units, in which the system tells its size and the mouse: 1,
/// or what screenScale is made of where units are large.
double pixelsPerUnit(GLFWwindow* window);

}  // namespace palpate
