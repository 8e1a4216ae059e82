#pragma once

#include <vector>

#include "viewer/haptics/deformed_shape.hpp"
#include "viewer/haptics/haptic_model.hpp"
#include "viewer/picture/body_view.hpp"
#include "viewer/picture/view_control.hpp"

namespace palpate {

/// All that is drawn of one model. Belongs to the thread of the Window. The model must outlive it.
class ShownModel {
 public:
  explicit ShownModel(const HapticModel& model);

  const HapticModel& model() const { return model_; }
  /// The ball around all vertices at rest, nearly the smallest.
  const FramedSphere& sphere() const { return sphere_; }
  BodyView& body() { return body_; }
  /// m, at the end of the colours of the surface: a round number that grows with what was seen.
  double fullColour() const { return full_colour_; }
  /// From where the touchable surface is seen best, a direction of any length: along its mean
  /// normal, and a little from above and beside it.
  Eigen::Vector3d bestView() const;
  /// Where the active node of a space is at rest, m.
  Eigen::Vector3d originOf(std::size_t space) const;

  /// The displacements of the surface in a touch of this model.
  void deform(const Touch& touch);
  /// Positions, normals and colours of what deform() said.
  void shade();

 private:
  const HapticModel& model_;
  FramedSphere sphere_;
  BodyView body_;
  DeformedShape deformed_;
  std::vector<float> displacements_;  ///< [vertex][axis], m
  double full_colour_ = 0.005;
};

}  // namespace palpate
