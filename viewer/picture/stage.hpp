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

/// What is drawn, in order: one body, the background, the lattice and the tool, in a light that
/// goes with the camera. Belongs to the thread in which a Window is current, and must go before it.
class Stage {
 public:
  /// extent: radius of what is shown, m; sizes of tool and lattice follow from it.
  explicit Stage(double extent) : tool_(extent, light_) {}

  /// The body that is drawn from now on; must outlive the stage or its replacement.
  void setBody(BodyView& body);
  ToolView& tool() { return tool_; }
  LatticeView& lattice() { return lattice_; }
  OrbitCamera& camera() { return camera_; }
  /// Draws into the part of the window. clear: before, and the rest becomes the ground of the
  /// panels. OpenGL's state is as before then.
  void render(const Viewport& viewport, bool clear = true);

 private:
  void placeCamera(const Viewport& viewport) const;

  OrbitCamera camera_;
  SoftLight light_;
  ToolView tool_;
  LatticeView lattice_;
  BodyView* body_ = nullptr;
};

}  // namespace palpate
