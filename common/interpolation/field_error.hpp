#pragma once

#include "common/interpolation/energy_jets.hpp"

namespace palpate {

/// A-posteriori bound on the force error of the quintic energy interpolant (energy_jets.hpp).
///
/// Every corner of a leaf, unless it is hanging, has a local polynomial of the energy. The bound is
/// based on the differences between the forces of these polynomials and the force of the
/// interpolant. The trilinearly weighted mean of these differences shows how well the data around a
/// place agree. It is zero at solved corners and continuous across faces. For equal differences,
/// the bound is larger near ghost corners, suspect edges (branch_check.hpp), and rest if fibres let
/// the stiffness jump there. At a hanging
/// corner, which has no polynomial, the mean difference of the other corners is used, and the bound
/// of the coarser leaf there is added with the corner's weight.
///
/// The factors come from measurements; see field_error.cpp and docs/internals/measurements.md.
/// Immutable after construction, so any thread may read.
class FieldError {
 public:
  FieldError() = default;  ///< an object without leaves, for which bound() must not be called
  /// All arguments must belong to the same space. No reference to them is kept.
  /// `has_fibers`: SpaceTable::has_fibers.
  FieldError(const CellTree& tree, const std::vector<LocalPolynomial>& polynomials,
             const std::vector<EnergyJet>& jets, const std::vector<LatticeEdge>& suspect,
             bool has_fibers = false);

  /// Returns the bound on the magnitude of the force error, N, at a place in a leaf. It is
  /// interpolated trilinearly between 27 grid nodes of the leaf. Real time.
  double bound(std::int32_t leaf, const Eigen::Vector3d& local) const noexcept;

 private:
  using Nodes = std::array<float, 27>;  ///< node (i, j, k), 0..2 along the axes, at [i + 3 j + 9 k]
  std::vector<Nodes> nodes_;            ///< per leaf
};

}  // namespace palpate
