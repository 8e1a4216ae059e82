#pragma once

#include "common/interpolation/energy_jets.hpp"

namespace palpate {

/// A-posteriori bound on the force error of the quintic energy interpolant (energy_jets.hpp).
///
/// Every corner of a leaf has a local polynomial of the energy. The differences between the forces
/// of these polynomials and the interpolant, weighted trilinearly, measure how well the data around
/// a place agree. They are zero at solved corners and continuous across faces. Ghost corners and
/// suspect edges (branch_check.hpp) increase the bound for the same difference. A hanging corner
/// adds the bound of its coarser leaf.
///
/// The factors were measured; see field_error.cpp and docs/measurements.md. Immutable after
/// construction, so any thread may read.
class FieldError {
 public:
  FieldError() = default;  ///< without leaves
  /// All arguments must belong to the same space; none is kept.
  FieldError(const CellTree& tree, const std::vector<LocalPolynomial>& polynomials,
             const std::vector<EnergyJet>& jets, const std::vector<LatticeEdge>& suspect);

  /// Returns the bound on |force error|, N. It is sampled at 27 grid nodes of the leaf and
  /// trilinear between them. Real time.
  double bound(std::int32_t leaf, const Eigen::Vector3d& local) const noexcept;

 private:
  using Nodes = std::array<float, 27>;  ///< node (i, j, k), 0..2 along the axes, at [i + 3 j + 9 k]
  std::vector<Nodes> nodes_;            ///< per leaf
};

}  // namespace palpate
