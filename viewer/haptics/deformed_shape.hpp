#pragma once

#include <span>
#include <vector>

#include "viewer/haptics/contact.hpp"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate {

/// Shape of a touched body: displacements of all vertices of its surface.
///
/// Displacements are blended like forces, u = sum w_i u_i(p). In each u_i a vertex other than the
/// anchor moves by p, and displacements are interpolated between lattice points, so the surface
/// would miss the tool. A smooth correction makes the anchor move by exactly p (to float32). It
/// adds the missing displacement times a bump (1 - (r/R)^2)^2, with r the distance from the anchor
/// at rest and R twice the longest edges around it. The bump is C1. The correction is for
/// appearance, not mechanics, and changes nothing outside R.
///
/// One thread at a time. Allocates only at construction.
class DeformedShape {
 public:
  /// most_vertices: number of vertices of the largest surface.
  explicit DeformedShape(std::size_t most_vertices);

  /// Fills `out` with displacements, [vertex][axis], metres, length 3
  /// model.surface().vertices().size(); zero if nothing is touched. touch: a contact with this
  /// model. Does not allocate, lock, throw or log.
  void evaluate(const HapticModel& model, const Touch& touch, std::span<float> out) noexcept;

 private:
  void blend(const HapticModel& model, const Touch& touch, std::span<float> out) noexcept;
  std::vector<float> scratch_;
};

}  // namespace palpate
