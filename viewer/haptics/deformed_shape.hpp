#pragma once

#include <span>
#include <vector>

#include "viewer/haptics/contact.hpp"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate {

/// The shape of a body that is being touched: displacements of all vertices of its surface.
///
/// They are blended as the forces are, u = sum w_i u_i(p). In each u_i another vertex than the
/// anchor moves by p, and between lattice points displacements are interpolated, so the surface
/// would pass beside the tool. A smooth correction makes the anchor move by exactly p (to float32):
/// what is missing there, times a bump (1 - (r/R)^2)^2 of the distance r from the anchor at rest, R
/// twice the longest edges around it. The bump is C1; the correction is a matter of looks, not of
/// mechanics: outside of R it changes nothing.
///
/// One thread at a time. Allocates at construction alone.
class DeformedShape {
 public:
  /// most_vertices: of the largest surface it will be asked for.
  explicit DeformedShape(std::size_t most_vertices);

  /// Fills `out`, [vertex][axis], metres, 3 model.surface().vertices().size() long, with
  /// displacements; zero when nothing is touched. touch: of a contact with this model. Does not
  /// allocate, lock, throw or log.
  void evaluate(const HapticModel& model, const Touch& touch, std::span<float> out) noexcept;

 private:
  void blend(const HapticModel& model, const Touch& touch, std::span<float> out) noexcept;
  std::vector<float> scratch_;
};

}  // namespace palpate
