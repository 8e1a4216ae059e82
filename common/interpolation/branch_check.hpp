#pragma once

#include <functional>

#include "common/space/space_table.hpp"

namespace palpate {

/// How well one equilibrium, `step` metres from another, continues it: what of the changes of force
/// and energy between the two the forces and stiffnesses at both do not explain. K step are the
/// changes of force over the whole step at either stiffness; their mean length is `change`, the
/// length of their difference `bend`.
struct EdgeCheck {
  /// N, |F_b - F_a - (K_a + K_b) / 2 step|: error of the trapezoidal rule.
  double force_mismatch = 0;
  /// N, that of the corrected trapezoidal rule for E_b - E_a, by |step|.
  double energy_mismatch = 0;
  double change = 0;  ///< N
  double bend = 0;    ///< N
  /// 0 to 1: forces of the space against those that the thresholds in newtons were measured with.
  double scale = 1;

  /// False only when no smooth branch plausibly joins the two. Where the stiffness changes
  /// monotonically the force mismatch is at most bend / 2; bend is allowed, so that a stiffness
  /// with an extremum on the way passes too.
  bool consistent() const;
  /// True when the stiffnesses explain so little that a jump would not stand out: every edge that
  /// is not consistent, and those too long for the curvature along them. Worth solving anew along
  /// another way; not worth giving up order.
  bool suspect() const;
};
/// Of the step from a to b. largest_force: N, of the space; thresholds in newtons shrink with it,
/// so that a jump shows in a soft body as it does in a stiff one.
EdgeCheck checkEdge(const ToolEquilibrium& a, const ToolEquilibrium& b, const Eigen::Vector3d& step,
                    double largest_force);

/// The edges whose two ends lie on different branches of solutions, or with a fold between: no
/// interpolation may treat the force between them as smooth. Sorted by (a, b). Points that are not
/// solved are in no edge.
///
/// Tested are the edges of the leaf cells: the cells of the uniform lattice, and the eighths of
/// split cells, that were not split themselves. So in an unrefined lattice every pair of solved
/// points one spacing apart along an axis, and where levels meet the whole edge of the coarse cell
/// and the halves of the fine one. Any thread.
///
/// The thresholds were measured on liver-493 (Mooney-Rivlin, eight active nodes, 33 mm spacing,
/// pushed up to 100 mm inwards), following every edge in 32 steps from either end. Of 2177 edges
/// that are smooth none is inconsistent and 56 are suspect. Of 79 with a jump 35 are inconsistent
/// and 74 suspect; those not even suspect have mismatches below 2 N. Of the jumps that pass as
/// consistent, all change the stiffness by more than the force: smooth interpolation there was not
/// worse than tri-linear.
std::vector<LatticeEdge> inconsistentEdges(const SpaceTable& space);

/// The equilibrium of a point by its lattice number; null when it is not solved.
using EquilibriumOf = std::function<const ToolEquilibrium*(std::int32_t)>;
/// The same of a space that is no table: of its lattice, and its cells that were split (in the
/// order of coarserFirst).
std::vector<LatticeEdge> inconsistentEdges(const Lattice& lattice,
                                           const std::vector<LatticeCell>& splits,
                                           const EquilibriumOf& equilibriumOf);

/// The same for EdgeCheck::suspect.
std::vector<LatticeEdge> suspectEdges(const SpaceTable& space);

}  // namespace palpate
