#pragma once

#include <string>
#include <vector>

#include "viewer/picture/image.hpp"

struct GLFWwindow;

namespace palpate {

/// A window with an OpenGL 2.1 context that is current in its thread. Create and use it in the main
/// thread of the process only (GLFW); one window at a time.
class Window {
 public:
  /// width, height: at scale 1; multiplied by screenScale. vsync: swap() waits for the screen.
  /// Throws Error with a remedy if there is no display or no OpenGL.
  Window(const std::string& title, int width, int height, bool visible, bool vsync);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  GLFWwindow* handle() const { return window_; }
  bool wantsClose() const;
  void poll();  ///< processes user and system events since the last call
  /// Keys (GLFW_KEY_*) pressed before the last poll(), in order, however short.
  const std::vector<int>& keys() const { return keys_; }
  /// Likewise, with the repeats of keys that are held down.
  const std::vector<int>& strokes() const { return strokes_; }
  void swap();  ///< shows the drawn picture

 private:
  GLFWwindow* window_ = nullptr;
  std::vector<int> keys_, strokes_;
};

/// Returns the pixels drawn since the last swap() of the current window, width x height from its
/// lower left.
Image readPixels(int width, int height);

}  // namespace palpate
