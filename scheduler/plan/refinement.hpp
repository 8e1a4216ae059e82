#pragma once

#include "common/scene/scene.hpp"
#include "common/space/space_table.hpp"

namespace palpate {

/// The next refinement step of an adaptive build for one configuration space.
struct Refinement {
  /// New positions to solve, sorted by (squared norm, coordinates). Add all of them to the lattice,
  /// even if they then fail. Some may lie outside the workspace ball.
  std::vector<LatticePoint> points;
  /// Cells to split, sorted by level and then by lowest corner. Add them to SpaceTable::splits when
  /// you add the points.
  std::vector<LatticeCell> splits;
  /// Likely number of points that later refinement steps will ask for. This is only a forecast; no
  /// result depends on it.
  double later = 0;
  /// Fraction (0 to 1) of the ball in which the likely force error meets the accuracy; for a
  /// finger, the fraction of the positions where the accuracy is required.
  double kept = 1;
  bool empty() const { return points.empty() && splits.empty(); }
};

/// Computes the next refinement step: the corners to solve and the leaf cells to split so that the
/// force meets scene.accuracy. The step is empty if the accuracy is met in 99.8 % of the ball or if
/// nothing can improve it; `kept` tells which is the case.
///
/// The likely error is a fifth of the bound of field_error.hpp. It is compared with the allowed
/// error, max(force_error |F|, force_floor), at 125 positions of every leaf. If a leaf exceeds the
/// allowed error, its untried corners are solved first, including corners slightly outside the
/// ball. When all corners have been tried, the leaf is split. These leaves are not split:
/// - leaves that were split scene.accuracy.levels times;
/// - leaves whose solved corners are all terminating;
/// - leaves crossed by a jump between branches (branch_check.hpp).
///
/// For a finger:
/// - The accuracy is required only for displacements to which contact can push the finger
///   (Finger::reach) with at most max_force.
/// - It is enough that 99 % of these positions meet the accuracy.
/// - A leaf with a failed corner or an apparent jump is split only once.
/// - A leaf at the rest position is an exception to the last two rules if one of its edges leads
///   from rest to a failed corner: it is split as often as `levels` allows, unless it has an
///   apparent jump. The tissue is then stiff relative to the spacing, and nearly everything that a
///   hand feels lies in that leaf.
///
/// Begin with a coarse lattice, spacing = radius / 2 (33 points): refinement adds the points that
/// are needed. A spacing as large as the radius gives too few points to judge by, and radius / 3
/// already has more points than many scenes need.
///
/// Deterministic. Neither probes nor failed attempts have an influence. Every point of the lattice
/// must have been tried; a point with the tag unknown counts as failed. Throws if no point is
/// solved, the scene is not adaptive, or the lattice does not have lattice_divisions. Any thread.
Refinement nextRefinement(const SpaceTable& space, const Scene& scene);

}  // namespace palpate
