#pragma once

#include "viewer/fields/cell_field.hpp"

namespace palpate {

/// The paper's method: tri-linear interpolation of each force component between the 8 corners of
/// the leaf. It is exact for forces that are linear in each coordinate; the error is proportional
/// to spacing^2. The force is continuous, but not conservative: a closed loop can return energy.
/// The stiffness (its exact derivative) jumps between leaves and need not be symmetric.
///
/// Error bound: for each axis, the largest change of stiffness along an edge of the leaf, times the
/// length of the edge, divided by eight; summed over the axes. This is the standard bound |f''| h^2
/// / 8 for linear interpolation, with f'' estimated from the stiffnesses.
class TrilinearField : public CellField {
 public:
  /// Error if no point of the space is solved.
  explicit TrilinearField(const SpaceTable& space) : TrilinearField(CellData(space)) {}

 protected:
  void interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                   ForceSample& sample) const noexcept override;

 private:
  explicit TrilinearField(const CellData& data);

  std::vector<double> error_bound_;  ///< per leaf, N
};

}  // namespace palpate
