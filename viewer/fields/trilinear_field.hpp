#pragma once

#include "viewer/fields/cell_field.hpp"

namespace palpate {

/// The paper's method: each component of the force is interpolated tri-linearly between the 8
/// corners of the leaf. Exact for forces that are linear in each coordinate; the error goes with
/// spacing^2. Continuous, but not conservative: a closed loop can return energy, and the stiffness
/// (its exact derivative) jumps between leaves and need not be symmetric.
///
/// Error bound: an eighth of the largest change of the stiffness along an edge times that edge,
/// summed over the axes: the error of linear interpolation with the curvature that the stiffnesses
/// show.
class TrilinearField : public CellField {
 public:
  /// Error when no point of the space is solved.
  explicit TrilinearField(const SpaceTable& space) : TrilinearField(CellData(space)) {}

 protected:
  void interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                   ForceSample& sample) const noexcept override;

 private:
  explicit TrilinearField(const CellData& data);

  std::vector<double> error_bound_;  ///< per leaf, N
};

}  // namespace palpate
