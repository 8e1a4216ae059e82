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

/// Draws one model: its surface, as tissue or coloured by a quantity, and its shape at rest as a
/// ghost where the surface is deformed. The ghost consists of an outline and a translucent fill,
/// which shows only outside the deformed body. Used by the thread of the Window only. The model
/// must outlive this object.
class BodyView {
 public:
  explicit BodyView(const HapticModel& model);

  const HapticModel& model() const { return model_; }
  /// Returns a ball around all vertices at rest, nearly the smallest.
  const FramedSphere& sphere() const { return sphere_; }
  /// Returns the end of the displacement scale, m. It is a round number and grows with the largest
  /// displacement since the body was last at rest, or since forgetScale().
  double fullColour() const { return full_colour_; }
  /// Returns the end of the pressure scale, Pa. It is a round number and grows with the
  /// strengthOf() of the pressures shown, up to about SurfacePressures::usual(). It is 0 until
  /// pressures are shown.
  double fullPressure() const { return full_pressure_; }
  /// Makes the scales at least as large as those of another view. Takes effect with the next
  /// shade().
  void useScaleOf(const BodyView& other) {
    full_colour_ = std::max(full_colour_, other.full_colour_);
    full_pressure_ = std::max(full_pressure_, other.full_pressure_);
  }
  /// Resets the scales, which begin again with the next shade().
  void forgetScale();
  /// Returns whether some parts of the surface are not touchable.
  bool hasUntouchable() const { return has_untouchable_; }
  /// Returns the direction from which the touchable surface is seen best, of any length. This is
  /// the mean normal of the touchable surface, turned to the side and slightly upward. If the body
  /// is touchable all around, it is the direction in which the body is thinnest, slightly from
  /// above.
  Eigen::Vector3d bestView() const;
  /// Returns the rest position of the active node of a space, m.
  Eigen::Vector3d originOf(std::size_t space) const;

  void setShadow(const SoftLight::Shadow& shadow) { shadow_ = shadow; }
  void showGhost(bool shown) { ghost_ = shown; }
  /// Computes the displacements of the surface for a touch of this model, and for a second finger
  /// that holds it. The pressures are those of the first touch.
  void deform(const Touch& touch, const std::optional<Touch>& held = {});
  /// Computes positions, normals and colours. Call after deform().
  ///
  /// method: must be prepared. Showing its error bounds for the first time takes a few
  /// milliseconds. If pressures are missing or not prepared yet, the surface is shown as tissue.
  void shade(SurfaceColour colour, std::int32_t method);

  // The following functions change OpenGL's state, and require its default state when they are
  // called (Stage).
  void draw(const SoftLight& light) const;
  /// Draws the soft edges and the ghost. Call it after the body and its background are drawn.
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
  SpaceBlend blend_;                  ///< blend of the touch that deforms the body; empty at rest
  Eigen::Vector3d touch_displacement_ = Eigen::Vector3d::Zero();  ///< m
  std::vector<float> pressures_;  ///< per vertex, Pa; empty until first shown
  double full_colour_ = 0, full_pressure_ = 0;
  bool has_untouchable_ = false;
  std::map<std::int32_t, std::vector<float>> error_places_;  ///< per method and vertex: position on
                                                             ///< the error scale, 0 to 1
  SoftLight::Shadow shadow_;
  bool ghost_ = true;
  std::vector<float> ghost_shares_;           ///< per vertex, 0 (no ghost) to 1
  std::vector<std::uint32_t> ghost_colours_;  ///< per vertex: red, green, blue and opacity as bytes
  std::vector<std::uint32_t> ghost_corners_;  ///< corners of the triangles with a share above 0
};

/// Returns the relative error bound of the force (relativeError) at each surface vertex, for a tool
/// that is pressed straight in by half the workspace radius. NaN if the vertex is not touchable, or
/// if the method gives no bound there. method: must be prepared. Evaluates the field once per
/// vertex; takes a few milliseconds in all.
std::vector<double> vertexErrors(const HapticModel& model, std::size_t method);

}  // namespace palpate
