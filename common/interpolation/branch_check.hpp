#pragma once

#include <functional>

#include "common/space/space_table.hpp"

namespace palpate {

/// Measures whether two equilibria a and b, whose displacements differ by `step` metres, can lie on
/// one smooth solution branch. The mismatches are the parts of the changes of force and energy that
/// the forces and stiffnesses at both ends do not explain. Each end predicts a change of force over
/// the step, namely the stiffness K at that end times the step. `change` is the mean length of
/// these two predictions, and `bend` is the length of their difference.
struct EdgeCheck {
  /// N, |F_b - F_a - (K_a + K_b) / 2 step|: residual of the trapezoidal rule.
  double force_mismatch = 0;
  /// N, residual of the corrected trapezoidal rule for E_b - E_a, divided by |step|.
  double energy_mismatch = 0;
  double change = 0;  ///< N
  double bend = 0;    ///< N
  /// 0 to 1: factor for the thresholds in newtons. It is below 1 if the largest force of the space
  /// is smaller than the largest force in the measurements from which the thresholds were chosen.
  double scale = 1;

  /// Returns false only if it is implausible that a smooth branch joins a and b. If the stiffness
  /// changes monotonically from a to b, the force mismatch is at most bend / 2. Mismatches up to
  /// bend are allowed, because the stiffness may have an extremum between a and b.
  bool consistent() const;
  /// Returns true if the stiffnesses explain so little of the change that a jump between branches
  /// could go unnoticed. True for every edge that is not consistent, and for long edges along which
  /// the stiffness changes much. The ends of a suspect edge are worth solving again along another
  /// path, but interpolation along the edge keeps its order.
  bool suspect() const;
};
/// Checks the step from a to b. `largest_force` is the largest force in the configuration space, N.
/// The thresholds in newtons shrink with this force, so that jumps are also found in soft bodies.
EdgeCheck checkEdge(const ToolEquilibrium& a, const ToolEquilibrium& b, const Eigen::Vector3d& step,
                    double largest_force);

/// Returns the edges with ends on different solution branches, or on two sides of a fold, sorted by
/// (a, b). No interpolation may treat the force along such an edge as smooth. Only edges between
/// solved points are tested.
///
/// All edges of leaf cells are tested. A leaf is a cell of the uniform lattice, or an eighth of a
/// split cell, that is not split itself. In an unrefined lattice these are all pairs of solved
/// points that are one spacing apart along an axis. At the boundary between a coarse leaf and finer
/// ones, both the whole edge of the coarse leaf and its two halves are tested. Any thread.
///
/// The thresholds were chosen on liver-493 (Mooney-Rivlin, eight active nodes, 33 mm spacing,
/// pushed up to 100 mm inwards). To find the edges with a jump, every edge was solved in 32 steps
/// from either end. Of 2177 smooth edges, none is inconsistent and 56 are suspect. Of 79 edges with
/// a jump, 35 are inconsistent and 74 suspect; the other 5 have mismatches below 2 N. All jumps
/// that pass as consistent change the stiffness more than the force, and smooth interpolation
/// across them was no worse than trilinear interpolation.
std::vector<LatticeEdge> inconsistentEdges(const SpaceTable& space);

/// Returns the equilibrium of the point with this lattice number, or null if it is not solved.
using EquilibriumOf = std::function<const ToolEquilibrium*(std::int32_t)>;
/// Returns the inconsistent edges of a space given by its lattice and its split cells (sorted by
/// coarserFirst).
std::vector<LatticeEdge> inconsistentEdges(const Lattice& lattice,
                                           const std::vector<LatticeCell>& splits,
                                           const EquilibriumOf& equilibriumOf);

/// Returns the suspect edges (EdgeCheck::suspect), otherwise like inconsistentEdges.
std::vector<LatticeEdge> suspectEdges(const SpaceTable& space);

}  // namespace palpate
