#pragma once

#include "common/interpolation/energy_jets.hpp"

namespace palpate {

/// A-posteriori bound on the error of the force that the quintic interpolant of the energy gives
/// (energy_jets.hpp).
///
/// Every corner of a leaf has a local polynomial of the energy. How far their forces differ from
/// the interpolant's, weighted tri-linearly, tells how well the data around a place agree about it:
/// zero at solved corners, and continuous over faces. Ghost corners and suspect edges
/// (branch_check.hpp) make the same disagreement worth more; a hanging corner brings the bound that
/// the coarser leaf has there.
///
/// The factors were measured: see field_error.cpp and docs/measurements.md.
/// Immutable after construction: any thread may read.
class FieldError {
 public:
  FieldError() = default;  ///< of no leaf
  /// The arguments belong together; none is kept.
  FieldError(const CellTree& tree, const std::vector<LocalPolynomial>& polynomials,
             const std::vector<EnergyJet>& jets, const std::vector<LatticeEdge>& suspect);

  /// N, on |force error|: sampled at the 27 nodes of a grid over the leaf, tri-linear between them.
  /// Real time.
  double bound(std::int32_t leaf, const Eigen::Vector3d& local) const noexcept;

 private:
  using Nodes = std::array<float, 27>;  ///< node (i, j, k), 0..2 along the axes, at [i + 3 j + 9 k]
  std::vector<Nodes> nodes_;            ///< per leaf
};

}  // namespace palpate
