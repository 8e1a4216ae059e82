#pragma once

#include <string>
#include <vector>

#include "viewer/picture/image.hpp"

struct GLFWwindow;

namespace palpate {

/// A window with an OpenGL 2.1 context, current in the thread that made it. That must be the main
/// thread of the process, which alone may use it (GLFW); one window at a time.
class Window {
 public:
  /// width, height: at a scale of 1; it is larger by screenScale. vsync: swap() waits for the
  /// screen. Error, with what to do, when there is no display or no
  /// OpenGL.
  Window(const std::string& title, int width, int height, bool visible, bool vsync);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  GLFWwindow* handle() const { return window_; }
  bool wantsClose() const;
  void poll();  ///< takes in what person and system did since the last call
  /// Keys (GLFW_KEY_*) that went down before the last poll(), in order; short strokes count too.
  const std::vector<int>& keys() const { return keys_; }
  /// The same, and again for each time that one that is held down repeats.
  const std::vector<int>& strokes() const { return strokes_; }
  void swap();  ///< shows what was drawn

 private:
  GLFWwindow* window_ = nullptr;
  std::vector<int> keys_, strokes_;
};

/// What was drawn since the last swap() of the current window, width x height pixels from its lower
/// left.
Image readPixels(int width, int height);

}  // namespace palpate
