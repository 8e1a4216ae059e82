#pragma once

#include <span>
#include <vector>

#include "viewer/haptics/contact.hpp"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate {

/// Shape of a touched body: displacements of all vertices of its surface.
///
/// Displacements are blended like forces, u = sum w_i u_i(p). In u_i it is the active node of space
/// i that moves by p, not the anchor, and u_i is interpolated between lattice points. The blended
/// surface would therefore miss the tool. A smooth correction makes the anchor move by exactly p
/// (to float32). It adds the missing displacement times the bump (1 - (r/R)^2)^2, where r is the
/// distance from the anchor at rest. Each corner of the anchor's triangle has twice the length of
/// its longest edge as radius; R is interpolated from these radii to the anchor. The bump is C1.
/// The correction is for appearance, not mechanics, and changes nothing outside R.
///
/// The shapes of two fingers are added, each for the displacement that the other one leaves to it.
/// This is exact in linear elasticity.
///
/// One thread at a time. Allocates only at construction.
class DeformedShape {
 public:
  /// most_vertices: number of vertices of the largest surface that evaluate() is called for.
  explicit DeformedShape(std::size_t most_vertices);

  /// Fills `out` with displacements, [vertex][axis], metres, length 3
  /// model.surface().vertices().size(). They are zero if nothing is touched. touches: contacts with
  /// this model. Does not allocate, lock, throw or log.
  void evaluate(const HapticModel& model, std::span<const Touch> touches,
                std::span<float> out) noexcept;
  void evaluate(const HapticModel& model, const Touch& touch, std::span<float> out) noexcept {
    evaluate(model, {&touch, 1}, out);
  }

 private:
  void add(const HapticModel& model, const SpaceBlend& blend, const Eigen::Vector3d& displacement,
           std::span<float> out) noexcept;
  std::vector<float> scratch_;
};

}  // namespace palpate
