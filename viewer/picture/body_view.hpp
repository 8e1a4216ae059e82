#pragma once

#include <cstdint>
#include <vector>

#include "viewer/picture/surface_shape.hpp"

class SoAction;
class SoCallback;

namespace palpate {

/// Draws a SurfaceShape: shaded, with a line around what can be touched and, where it is deformed,
/// the shape at rest as a translucent ghost. A Coin node that draws vertex arrays: they change in
/// every picture, for which Coin's own shapes would build their caches anew each time.
class BodyView {
 public:
  explicit BodyView(SurfaceShape shape);
  ~BodyView();
  BodyView(const BodyView&) = delete;
  BodyView& operator=(const BodyView&) = delete;

  SoCallback* node() const { return node_; }
  SurfaceShape& shape() { return shape_; }
  const SurfaceShape& shape() const { return shape_; }
  void showGhost(bool shown) { ghost_ = shown; }
  /// Displacements shorter than this have no ghost, metres.
  void setGhostFrom(double length) { ghost_from_ = length; }

 private:
  static void render(void* view, SoAction* action);
  void drawSurface() const;
  void drawRim() const;
  void drawGhost();

  SurfaceShape shape_;
  SoCallback* node_;
  bool ghost_ = true;
  double ghost_from_ = 1e-3;
  std::vector<std::uint32_t> ghost_edges_, ghost_corners_;  ///< what is drawn of the ghost
};

}  // namespace palpate
