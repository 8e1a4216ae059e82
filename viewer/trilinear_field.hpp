#pragma once

#include <vector>

#include "viewer/cell_grid.hpp"
#include "viewer/force_field.hpp"

namespace palpate {

/// The paper's method: each component of the force is interpolated tri-linearly between the 8 corners of the
/// cell. Exact for forces that are linear in each coordinate; the error goes with spacing^2. Continuous, but
/// not conservative: a closed loop can return energy, and the stiffness (its exact derivative) jumps between
/// cells and need not be symmetric.
class TrilinearField : public ForceField {
 public:
  explicit TrilinearField(const SpaceTable& space);
  ForceSample evaluate(const Eigen::Vector3d& displacement) const noexcept override;
  std::string_view name() const override { return "trilinear"; }

 private:
  CellGrid grid_;
  std::vector<Equilibrium> points_;            ///< per lattice point
  std::vector<Eigen::Vector3d> displacement_;  ///< per lattice point, metres
};

}  // namespace palpate
