#pragma once

#include "common/interpolation/energy_jets.hpp"

namespace palpate {

/// Returns energy, force and stiffness at every slot of a tree (a slot is a corner that leaves
/// share), for methods that interpolate nodal data. The data depend on the kind of the slot:
///
///   solved   the data of the lattice point
///   ghost    not solved: the values of a local polynomial of the energy (energy_jets.hpp)
///   hanging  zero, because the method interpolates them itself (fillHanging in cell_tree.hpp)
///
/// A ghost's polynomial fits the data of the nearest solved points. It is exact for energies up to
/// the third degree if enough solved points are near; with fewer points its order is lower. With a
/// single point it is the second-order expansion of the energy there. If the force of the
/// polynomial differs too much from the forces of these points, its degree is lowered, down to 2.
///
/// ghosts: ghostPolynomials of the same tree and space, one per slot; no polynomial is fitted to
/// both ends of an inconsistent edge. The result is bitwise the same on all machines of the same
/// type. Any thread.
std::vector<Equilibrium> slotEquilibria(const CellTree& tree, const SpaceTable& space,
                                        const std::vector<LocalPolynomial>& ghosts);

/// Returns the coverage of every slot, 0..1: 1 at solved points without an inconsistent edge, 0 at
/// ghosts and at the ends of inconsistent edges. A hanging slot has the interpolated coverage of
/// its coarser leaf. Tri-linear interpolation in a leaf gives the coverage of a sample.
std::vector<double> slotCoverage(const CellTree& tree,
                                 const std::vector<LatticeEdge>& inconsistent);

/// Returns the tri-linear interpolant of `values`, one per slot, at a place in a leaf.
template <class Value>
Value trilinear(const LeafCorners& corners, const Eigen::Vector3d& local,
                const std::vector<Value>& values) {
  const std::array<double, 8> weights = trilinearWeights(local);
  Value sum = weights[0] * values[at(corners[0])];
  for (std::size_t c = 1; c < 8; ++c) sum += weights[c] * values[at(corners[c])];
  return sum;
}

/// Sets the values of all hanging slots to the tri-linear interpolant in their coarser leaf.
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
  /// Index of the lattice point at each slot, including hanging slots; -1 if no lattice point lies
  /// there.
  std::vector<std::int32_t> numbers;

  /// Returns whether two slots are the ends of an inconsistent edge.
  bool isInconsistent(std::int32_t a, std::int32_t b) const;
};

/// A cell tree with nodal data at its slots, from which methods interpolate in the leaves.
struct CellData : CellBranches {
  explicit CellData(const SpaceTable& space);
  /// The same, with `fits` that spaces with equal lattices may share.
  CellData(const SpaceTable& space, LocalFits& fits);

  std::vector<LatticeEdge> suspect;     ///< suspectEdges of the space
  std::vector<LocalPolynomial> ghosts;  ///< ghostPolynomials, per slot
  std::vector<Equilibrium> equilibria;  ///< slotEquilibria, per slot
  std::vector<double> support;          ///< slotCoverage, per slot
  std::int32_t divisions;               ///< lattice coordinates per spacing
  double max_force;                     ///< N, SpaceTable::max_force
  bool has_fibers;                      ///< SpaceTable::has_fibers

  CellData(const SpaceTable& space, LocalFits&& fits);
  /// Returns the slot at lattice coordinates; -1 if there is none.
  std::int32_t slotAt(const LatticePoint& point) const;
  /// Returns the leaves that have at least one of these edges; `edges` must be sorted.
  std::vector<std::int32_t> leavesWith(const std::vector<LatticeEdge>& edges) const;
};

}  // namespace palpate
