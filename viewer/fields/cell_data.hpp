#pragma once

#include "common/interpolation/energy_jets.hpp"

namespace palpate {

/// Energy, force and stiffness for every slot of a tree, for methods that interpolate nodal data.
///
///   solved   those of the lattice point
///   ghost    those of the local polynomial of the energy (energy_jets.hpp)
///   hanging  zero: the method fills them itself (fillHanging in cell_tree.hpp)
///
/// A ghost's polynomial goes through the data of the nearest solved points: exact for energies up
/// to the third degree where enough of them are near, of lower order with fewer; a lone point is
/// continued by its force and stiffness. Forces are limited by what the neighbours span.
/// `ghosts`: ghostPolynomials of the same tree and space, one per slot; none mixes points that an
/// inconsistent edge joins. The same numbers on every machine of one kind. Any thread.
std::vector<Equilibrium> slotEquilibria(const CellTree& tree, const SpaceTable& space,
                                        const std::vector<LocalPolynomial>& ghosts);

/// For every slot the share (0..1) of it that stands on solved points without an inconsistent edge:
/// 1, 0 for ghosts and ends of inconsistent edges, in between where a slot hangs. Interpolated
/// tri-linearly in a leaf it is the coverage of a sample.
std::vector<double> slotCoverage(const CellTree& tree,
                                 const std::vector<LatticeEdge>& inconsistent);

/// Tri-linear interpolant of nodal values, one per slot, at a place in a leaf.
template <class Value>
Value trilinear(const LeafCorners& corners, const Eigen::Vector3d& local,
                const std::vector<Value>& values) {
  const std::array<double, 8> weights = trilinearWeights(local);
  Value sum = weights[0] * values[at(corners[0])];
  for (std::size_t c = 1; c < 8; ++c) sum += weights[c] * values[at(corners[c])];
  return sum;
}

/// Sets the values of all hanging slots, one per slot, to those that are tri-linear in the coarser
/// leaf.
template <class Value>
void fillHangingTrilinearly(const CellTree& tree, std::vector<Value>& values) {
  fillHanging(tree, values, [&](std::int32_t leaf, const Eigen::Vector3d& local) {
    return trilinear(tree.corners(leaf), local, values);
  });
}

/// A cell tree and where it lies on more than one branch. Holds no reference to the space.
/// Immutable after construction: any thread may read.
struct CellBranches {
  /// Error when no point of the space is solved.
  explicit CellBranches(const SpaceTable& space);

  CellTree tree;
  std::vector<LatticeEdge> inconsistent;  ///< inconsistentEdges of the space
  /// Per slot: lattice number, of hanging ones too; -1 when it has none.
  std::vector<std::int32_t> numbers;

  /// Whether two slots are the ends of an inconsistent edge.
  bool isInconsistent(std::int32_t a, std::int32_t b) const;
};

/// What methods that interpolate in leaves are made of: a cell tree and what its slots stand on.
struct CellData : CellBranches {
  explicit CellData(const SpaceTable& space);
  /// With fits that other spaces on such a lattice share.
  CellData(const SpaceTable& space, LocalFits& fits);

  std::vector<LatticeEdge> suspect;     ///< suspectEdges of the space
  std::vector<LocalPolynomial> ghosts;  ///< ghostPolynomials
  std::vector<Equilibrium> equilibria;  ///< slotEquilibria
  std::vector<double> support;          ///< slotCoverage
  std::int32_t divisions;               ///< lattice coordinates per spacing
  double max_force;                     ///< N, SpaceTable::max_force

  CellData(const SpaceTable& space, LocalFits&& fits);
  /// The slot at lattice coordinates; -1 when there is none.
  std::int32_t slotAt(const LatticePoint& point) const;
  /// The leaves with an edge among these; sorted edges.
  std::vector<std::int32_t> leavesWith(const std::vector<LatticeEdge>& edges) const;
};

}  // namespace palpate
