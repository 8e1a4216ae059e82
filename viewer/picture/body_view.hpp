#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "viewer/haptics/deformed_shape.hpp"
#include "viewer/haptics/haptic_model.hpp"
#include "viewer/picture/contour.hpp"
#include "viewer/picture/framed_sphere.hpp"
#include "viewer/picture/soft_light.hpp"
#include "viewer/picture/surface_shape.hpp"

namespace palpate {

/// All that is drawn of one model: its surface as tissue, or coloured by what is known of it, and
/// where it is deformed the shape at rest as a ghost: its outline, and a translucent fill of what
/// of it stands out beyond the body. Belongs to the thread of the Window. The model must outlive
/// it.
class BodyView {
 public:
  explicit BodyView(const HapticModel& model);

  const HapticModel& model() const { return model_; }
  /// The ball around all vertices at rest, nearly the smallest.
  const FramedSphere& sphere() const { return sphere_; }
  /// m, at the end of the colours of the surface: a round number that grows with what was seen
  /// since the body was at rest, or forgetScale().
  double fullColour() const { return full_colour_; }
  /// Pa, the same of how strong pressures were, up to the usual(). 0: none were seen yet.
  double fullPressure() const { return full_pressure_; }
  /// The same colours as another's mean the same from the next shade() on.
  void useScaleOf(const BodyView& other) {
    full_colour_ = std::max(full_colour_, other.full_colour_);
    full_pressure_ = std::max(full_pressure_, other.full_pressure_);
  }
  /// The scales begin anew with the next shade().
  void forgetScale();
  /// Whether there are parts where nothing can be felt.
  bool hasUntouchable() const { return has_untouchable_; }
  /// From where the touchable surface is seen best, a direction of any length: along its mean
  /// normal, and a little from above and beside it; of a body that is touched all around along its
  /// thinnest axis.
  Eigen::Vector3d bestView() const;
  /// Where the active node of a space is at rest, m.
  Eigen::Vector3d originOf(std::size_t space) const;

  void setShadow(const SoftLight::Shadow& shadow) { shadow_ = shadow; }
  void showGhost(bool shown) { ghost_ = shown; }
  /// The displacements of the surface in a touch of this model.
  void deform(const Touch& touch);
  /// Positions, normals and colours of what deform() said. method: prepared; of the error bounds,
  /// which take some milliseconds when they are seen for the first time. Without pressures, or
  /// before they are prepared, tissue.
  void shade(SurfaceColour colour, std::int32_t method);

  // They change OpenGL's state, and begin with its default (Stage).
  void draw(const SoftLight& light) const;
  /// Its soft edges and the ghost: after the body and what is behind both.
  void drawOver(const SoftLight& light);

 private:
  void useSurface() const;
  void drawContour(const SoftLight& light);
  void drawGhost();
  void colourGhost(const std::array<std::uint8_t, 3>& colour, float opacity);
  const std::vector<float>& errorPlacesOf(std::int32_t method);
  void colourPressures();

  const HapticModel& model_;
  FramedSphere sphere_;
  SurfaceShape shape_;
  Contour contour_;
  DeformedShape deformed_;
  std::vector<float> displacements_;  ///< [vertex][axis], m
  SpaceBlend blend_;                  ///< of the touch that deformed it; of no space: at rest
  Eigen::Vector3d touch_displacement_ = Eigen::Vector3d::Zero();  ///< m
  std::vector<float> pressures_;  ///< by vertex, Pa; empty until they are seen
  double full_colour_ = 0, full_pressure_ = 0;
  bool has_untouchable_ = false;
  std::map<std::int32_t, std::vector<float>> error_places_;  ///< by method; by vertex, 0 to 1
  SoftLight::Shadow shadow_;
  bool ghost_ = true;
  std::vector<float> ghost_shares_;           ///< by vertex, 0 to 1
  std::vector<std::uint32_t> ghost_colours_;  ///< by vertex, bytes
  std::vector<std::uint32_t> ghost_corners_;  ///< of triangles that have a share
};

}  // namespace palpate
