#pragma once

#include "common/interpolation/energy_jets.hpp"

namespace palpate {

/// Returns energy, force and stiffness for every slot of a tree, for methods that interpolate nodal
/// data:
///
///   solved   those of the lattice point
///   ghost    those of the local polynomial of the energy (energy_jets.hpp)
///   hanging  zero: the method fills them itself (fillHanging in cell_tree.hpp)
///
/// A ghost's polynomial fits the data of the nearest solved points. It is exact for energies up to
/// the third degree if enough of them are near, and of lower order with fewer. A lone point is
/// continued by its force and stiffness. Forces are limited to the range of the neighbours' forces.
///
/// ghosts: ghostPolynomials of the same tree and space, one per slot; none mixes points that an
/// inconsistent edge joins. The result is the same on every machine of one kind. Any thread.
std::vector<Equilibrium> slotEquilibria(const CellTree& tree, const SpaceTable& space,
                                        const std::vector<LocalPolynomial>& ghosts);

/// Returns for every slot the share (0..1) of it that rests on solved points without an
/// inconsistent edge. It is 1 for such points, 0 for ghosts and ends of inconsistent edges, and in
/// between for hanging slots. Tri-linear interpolation of it in a leaf gives the coverage of a
/// sample.
std::vector<double> slotCoverage(const CellTree& tree,
                                 const std::vector<LatticeEdge>& inconsistent);

/// Tri-linear interpolant at a place in a leaf; `values`: one per slot.
template <class Value>
Value trilinear(const LeafCorners& corners, const Eigen::Vector3d& local,
                const std::vector<Value>& values) {
  const std::array<double, 8> weights = trilinearWeights(local);
  Value sum = weights[0] * values[at(corners[0])];
  for (std::size_t c = 1; c < 8; ++c) sum += weights[c] * values[at(corners[c])];
  return sum;
}

/// Sets the values of all hanging slots to the tri-linear interpolant in the coarser leaf.
/// `values`: one per slot.
template <class Value>
void fillHangingTrilinearly(const CellTree& tree, std::vector<Value>& values) {
  fillHanging(tree, values, [&](std::int32_t leaf, const Eigen::Vector3d& local) {
    return trilinear(tree.corners(leaf), local, values);
  });
}

/// A cell tree and its edges between different solution branches. Holds no reference to the space.
/// Immutable after construction: any thread may read.
struct CellBranches {
  /// Error if no point of the space is solved.
  explicit CellBranches(const SpaceTable& space);

  CellTree tree;
  std::vector<LatticeEdge> inconsistent;  ///< inconsistentEdges of the space
  /// Lattice number per slot, also of hanging ones; -1 if there is none.
  std::vector<std::int32_t> numbers;

  /// Whether two slots are the ends of an inconsistent edge.
  bool isInconsistent(std::int32_t a, std::int32_t b) const;
};

/// Data of methods that interpolate in leaves: a cell tree and the nodal data of its slots.
struct CellData : CellBranches {
  explicit CellData(const SpaceTable& space);
  /// Uses fits that other spaces on the same kind of lattice share.
  CellData(const SpaceTable& space, LocalFits& fits);

  std::vector<LatticeEdge> suspect;     ///< suspectEdges of the space
  std::vector<LocalPolynomial> ghosts;  ///< ghostPolynomials
  std::vector<Equilibrium> equilibria;  ///< slotEquilibria
  std::vector<double> support;          ///< slotCoverage
  std::int32_t divisions;               ///< lattice coordinates per spacing
  double max_force;                     ///< N, SpaceTable::max_force

  CellData(const SpaceTable& space, LocalFits&& fits);
  /// Returns the slot at lattice coordinates; -1 if there is none.
  std::int32_t slotAt(const LatticePoint& point) const;
  /// Returns the leaves that have one of these edges; `edges` must be sorted.
  std::vector<std::int32_t> leavesWith(const std::vector<LatticeEdge>& edges) const;
};

}  // namespace palpate
