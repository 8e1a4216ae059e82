#pragma once

#include <algorithm>

#include "viewer/picture/body_view.hpp"
#include "viewer/picture/lattice_view.hpp"
#include "viewer/picture/orbit_camera.hpp"
#include "viewer/picture/soft_light.hpp"
#include "viewer/picture/tool_view.hpp"

namespace palpate {

/// A part of a window; pixels, from the left and the bottom.
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

/// What a part of the window shows. Body and lattice, where there are any, must outlive it.
struct Shot {
  BodyView* body = nullptr;
  const LatticeView* lattice = nullptr;
  ShownTool tool;
  OrbitCamera camera;
};

/// Draws shots in a light that goes with the camera. Belongs to the thread in which a Window is
/// current, and must go before it.
class Stage {
 public:
  /// Draws into the part of the window. clear: before, and the rest becomes the ground of the
  /// panels. OpenGL's state is as before then, but for its matrices.
  void render(const Shot& shot, const Viewport& viewport, bool clear = true) const;

 private:
  SoftLight light_;
  ToolView tool_;
};

}  // namespace palpate
