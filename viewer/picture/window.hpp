#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "viewer/picture/image.hpp"

struct GLFWwindow;

namespace palpate {

/// A window with an OpenGL 2.1 context that is current in its thread. Create it and use it only in
/// the main thread of the process (GLFW), and only one at a time.
class Window {
 public:
  /// width, height: at scale 1; they are multiplied by screenScale(). vsync: whether swap() waits
  /// for the screen. If there is no display or no OpenGL, throws an Error that says what to do.
  Window(const std::string& title, int width, int height, bool visible, bool vsync);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  GLFWwindow* handle() const { return window_; }
  bool wantsClose() const;
  void poll();  ///< processes user and system events since the last call
  /// Returns the keys (GLFW_KEY_*) whose presses the last poll() processed, in order, even if they
  /// were held only briefly.
  const std::vector<int>& keys() const { return keys_; }
  /// Returns what keys() returns, and in addition the repeats of keys that are held down.
  const std::vector<int>& strokes() const { return strokes_; }
  void swap();  ///< shows the frame that was drawn

 private:
  GLFWwindow* window_ = nullptr;
  std::vector<int> keys_, strokes_;
};

/// Returns the pixels that were drawn since the last swap() of the current window: width x height
/// pixels from the lower left.
Image readPixels(int width, int height);

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
