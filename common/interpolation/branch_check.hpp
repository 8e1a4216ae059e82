#pragma once

#include <functional>

#include "common/space/space_table.hpp"

namespace palpate {

/// Measures how well one equilibrium continues another, `step` metres away: the part of the changes
/// of force and energy that the forces and stiffnesses at both ends do not explain. K step is the
/// change of force over the step at the stiffness of either end. `change` is the mean length of the
/// two, `bend` the length of their difference.
struct EdgeCheck {
  /// N, |F_b - F_a - (K_a + K_b) / 2 step|: residual of the trapezoidal rule.
  double force_mismatch = 0;
  /// N, residual of the corrected trapezoidal rule for E_b - E_a, divided by |step|.
  double energy_mismatch = 0;
  double change = 0;  ///< N
  double bend = 0;    ///< N
  /// 0 to 1: largest force of the space relative to the one behind the thresholds in newtons.
  double scale = 1;

  /// Returns false only if no smooth branch plausibly joins the two. If the stiffness changes
  /// monotonically, the force mismatch is at most bend / 2. A mismatch up to bend is allowed, so
  /// that a stiffness with an extremum on the way passes too.
  bool consistent() const;
  /// Returns true if the stiffnesses explain so little that a jump would not stand out. That holds
  /// for every edge that is not consistent, and for edges too long for the curvature along them.
  /// The ends are worth solving again along another path, but the interpolation keeps its order.
  bool suspect() const;
};
/// Checks the step from a to b. `largest_force` is the space's, N; thresholds in newtons shrink
/// with it, so that a jump shows in a soft body as in a stiff one.
EdgeCheck checkEdge(const ToolEquilibrium& a, const ToolEquilibrium& b, const Eigen::Vector3d& step,
                    double largest_force);

/// Returns the edges between different solution branches or across a fold. No interpolation may
/// treat the force between them as smooth. Sorted by (a, b). Only edges between solved points are
/// tested.
///
/// All edges of leaf cells are tested. A leaf is a cell of the uniform lattice, or an eighth of a
/// split cell, that is not split itself. An unrefined lattice thus tests all pairs of solved points
/// one spacing apart along an axis. At a boundary between levels, the whole edge of the coarse cell
/// and both halves are tested. Any thread.
///
/// The thresholds were measured on liver-493 (Mooney-Rivlin, eight active nodes, 33 mm spacing,
/// pushed up to 100 mm inwards) by following every edge in 32 steps from either end. None of 2177
/// smooth edges is inconsistent, and 56 are suspect. Among 79 edges with a jump, 35 are
/// inconsistent and 74 suspect; the other 5 have mismatches below 2 N. All jumps that pass as
/// consistent change the stiffness by more than the force, and smooth interpolation across them was
/// no worse than trilinear.
std::vector<LatticeEdge> inconsistentEdges(const SpaceTable& space);

/// Returns the equilibrium of a point by its lattice number, null if it is not solved.
using EquilibriumOf = std::function<const ToolEquilibrium*(std::int32_t)>;
/// Returns the inconsistent edges of a space given by its lattice and its split cells (sorted by
/// coarserFirst).
std::vector<LatticeEdge> inconsistentEdges(const Lattice& lattice,
                                           const std::vector<LatticeCell>& splits,
                                           const EquilibriumOf& equilibriumOf);

/// Returns the suspect edges (EdgeCheck::suspect), otherwise like inconsistentEdges.
std::vector<LatticeEdge> suspectEdges(const SpaceTable& space);

}  // namespace palpate
