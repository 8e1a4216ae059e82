#pragma once

#include <algorithm>
#include <optional>

#include "viewer/picture/body_view.hpp"
#include "viewer/picture/lattice_view.hpp"
#include "viewer/picture/orbit_camera.hpp"
#include "viewer/picture/soft_light.hpp"
#include "viewer/picture/tool_view.hpp"

namespace palpate {

/// A part of a window, pixels. x and y are measured from the lower left.
struct Viewport {
  int window_width = 1, window_height = 1;
  int x = 0, y = 0, width = 1, height = 1;

  Viewport leftHalf() const {
    Viewport half = *this;
    half.width = std::max(width / 2, 1);
    return half;
  }
  Viewport rightHalf() const {
    Viewport half = leftHalf();
    half.x += half.width;
    return half;
  }
};

/// Contents of one part of the window. The body and the lattice may be null; otherwise they must
/// outlive this object.
struct Shot {
  BodyView* body = nullptr;
  const LatticeView* lattice = nullptr;
  ShownTool tool;
  std::optional<ShownTool> held;  ///< the second finger, which holds the body
  OrbitCamera camera;
};

/// Draws shots with a light that moves with the camera. Use it only in the thread in which a Window
/// is current. Must be destroyed before the Window.
class Stage {
 public:
  /// Draws a shot into a part of the window. clear: first fills the whole window with the
  /// background of the panels. Restores OpenGL's state except its matrices.
  void render(const Shot& shot, const Viewport& viewport, bool clear = true) const;

 private:
  SoftLight light_;
  ToolView tool_;
};

}  // namespace palpate
