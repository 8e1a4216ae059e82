#include "viewer/picture/screen_scale.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace palpate {

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

}  // namespace palpate
