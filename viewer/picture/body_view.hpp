#pragma once

#include <cstdint>
#include <vector>

#include "viewer/haptics/deformed_shape.hpp"
#include "viewer/haptics/haptic_model.hpp"
#include "viewer/picture/coin.hpp"
#include "viewer/picture/surface_shape.hpp"
#include "viewer/picture/view_control.hpp"

namespace palpate {

/// All that is drawn of one model: its surface, shaded, with a line around what can be touched and,
/// where it is deformed, the shape at rest as a translucent ghost. A Coin node that draws vertex
/// arrays: they change in every picture, for which Coin's own shapes would build their caches anew
/// each time. Belongs to the thread of the Window. The model must outlive it.
class BodyView {
 public:
  explicit BodyView(const HapticModel& model);

  SoCallback* node() const { return drawing_.node(); }
  const HapticModel& model() const { return model_; }
  /// The ball around all vertices at rest, nearly the smallest.
  const FramedSphere& sphere() const { return sphere_; }
  /// m, at the end of the colours of the surface: a round number that grows with what was seen.
  double fullColour() const { return full_colour_; }
  /// From where the touchable surface is seen best, a direction of any length: along its mean
  /// normal, and a little from above and beside it; of a body that is touched all around along its
  /// thinnest axis.
  Eigen::Vector3d bestView() const;
  /// Where the active node of a space is at rest, m.
  Eigen::Vector3d originOf(std::size_t space) const;

  void showGhost(bool shown) { ghost_ = shown; }
  /// The displacements of the surface in a touch of this model.
  void deform(const Touch& touch);
  /// Positions, normals and colours of what deform() said.
  void shade();

 private:
  void draw();
  void drawSurface() const;
  void drawRim() const;
  void drawGhost();

  const HapticModel& model_;
  FramedSphere sphere_;
  SurfaceShape shape_;
  DeformedShape deformed_;
  std::vector<float> displacements_;  ///< [vertex][axis], m
  double full_colour_ = 0.005;
  Drawing drawing_;
  bool ghost_ = true;
  std::vector<std::uint32_t> ghost_edges_, ghost_corners_;  ///< what is drawn of the ghost
};

}  // namespace palpate
