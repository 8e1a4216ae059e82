#include "viewer/picture/window.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <array>
#include <limits>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "viewer/picture/open_gl.hpp"

namespace palpate {
namespace {

// Smallest window, in units at scale 1. In a smaller window the panels would overlap.
constexpr int least_width = 480, least_height = 320;

/// Returns GLFW's message about its last error.
std::string lastTrouble() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text != nullptr ? text : "no reason given";
}

/// Returns the width and height, in units, that bars and docks leave for a window. There is no
/// limit if the screen is unknown or the window is not visible.
std::array<int, 2> roomOnScreen(bool visible) {
  std::array<int, 2> size{};
  if (GLFWmonitor* const screen = visible ? glfwGetPrimaryMonitor() : nullptr)
    glfwGetMonitorWorkarea(screen, nullptr, nullptr, size.data(), &size[1]);
  for (int& length : size)
    if (length <= 0) length = std::numeric_limits<int>::max();
  return size;
}

}  // namespace

double screenScale(GLFWwindow* window) {
  float across = 1, down = 1;
  glfwGetWindowContentScale(window, &across, &down);
  return roundedScale(std::min(across, down));
}

double pixelsPerUnit(GLFWwindow* window) {
  int units = 0, pixels = 0, height = 0;
  glfwGetWindowSize(window, &units, &height);
  glfwGetFramebufferSize(window, &pixels, &height);
  return units > 0 && pixels > 0 ? static_cast<double>(pixels) / units : 1;
}

Window::Window(const std::string& title, int width, int height, bool visible, bool vsync) {
  if (glfwInit() != GLFW_TRUE)
    throw failure(
        "no display for the picture ({}); use --headless, run under xvfb-run, or set DISPLAY",
        lastTrouble());
  glfwWindowHint(GLFW_VISIBLE, visible ? GLFW_TRUE : GLFW_FALSE);
  glfwWindowHint(GLFW_DEPTH_BITS, 24);
  glfwWindowHint(GLFW_STENCIL_BITS, 8);
  glfwWindowHint(GLFW_SAMPLES, 0);  // multisampling is too slow in software rendering
  window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (window_ == nullptr) {
    const std::string trouble = lastTrouble();
    glfwTerminate();
    throw failure(
        "cannot open a window with OpenGL 2.1 ({}); use --headless, or install libgl1-mesa-dri "
        "and set LIBGL_ALWAYS_SOFTWARE=1 to draw in software",
        trouble);
  }
  const double larger = screenScale(window_) / pixelsPerUnit(window_);
  const std::array<int, 2> room = roomOnScreen(visible);
  const auto fitted = [&](int across, int down) {
    return std::array{std::min(static_cast<int>(across * larger), room[0]),
                      std::min(static_cast<int>(down * larger), room[1])};
  };
  const auto least = fitted(least_width, least_height), size = fitted(width, height);
  glfwSetWindowSizeLimits(window_, least[0], least[1], GLFW_DONT_CARE, GLFW_DONT_CARE);
  if (size != std::array{width, height}) glfwSetWindowSize(window_, size[0], size[1]);
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(vsync ? 1 : 0);
  glfwSetWindowUserPointer(window_, this);
  // Set this before the panels set their callbacks, which call this one.
  glfwSetKeyCallback(window_,
                     [](GLFWwindow* window, int key, int /*code*/, int action, int /*modifiers*/) {
                       auto* const self = static_cast<Window*>(glfwGetWindowUserPointer(window));
                       if (action == GLFW_PRESS) self->keys_.push_back(key);
                       if (action != GLFW_RELEASE) self->strokes_.push_back(key);
                     });
}

Window::~Window() {
  glfwDestroyWindow(window_);
  glfwTerminate();
}

bool Window::wantsClose() const { return glfwWindowShouldClose(window_) != GLFW_FALSE; }

void Window::poll() {
  keys_.clear();
  strokes_.clear();
  glfwPollEvents();
}

void Window::swap() { glfwSwapBuffers(window_); }

Image readPixels(int width, int height) {
  PALPATE_ASSERT(width > 0 && height > 0, "a window must have pixels");
  const std::size_t row = 3 * static_cast<std::size_t>(width),
                    rows = static_cast<std::size_t>(height);
  std::vector<std::uint8_t> upward(row * rows);
  // Rows of three bytes per pixel are not padded.
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadBuffer(GL_BACK);
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, upward.data());
  Image image{width, height, std::vector<std::uint8_t>(upward.size())};
  for (std::size_t y = 0; y < rows; ++y)
    std::copy_n(upward.data() + row * (rows - 1 - y), row, image.pixels.data() + row * y);
  return image;
}

}  // namespace palpate
