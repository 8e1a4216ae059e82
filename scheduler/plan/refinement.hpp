#pragma once

#include "common/scene/scene.hpp"
#include "common/space/space_table.hpp"

namespace palpate {

/// The next refinement step of an adaptive build for one configuration space.
struct Refinement {
  /// Positions to solve that are not in the lattice yet, sorted by (squared norm, coordinates). All
  /// are to be added to the lattice, even if they then fail. Some may lie outside the workspace
  /// ball.
  std::vector<LatticePoint> points;
  /// Cells to split, sorted by (level, lowest). Merge them into SpaceTable::splits together with
  /// the points.
  std::vector<LatticeCell> splits;
  /// Likely number of points that later rounds will ask for. Only a forecast: no result depends on
  /// it.
  double later = 0;
  /// Share (0..1) of the ball in which the likely force error meets the accuracy.
  double kept = 1;
  bool empty() const { return points.empty() && splits.empty(); }
};

/// Returns the corners to solve and the leaf cells to split so that the force meets scene.accuracy.
/// Empty when the accuracy is met in 99.8 % of the ball or cannot be improved; `kept` tells these
/// apart.
///
/// The likely error is a fifth of the bound of field_error.hpp. At 125 positions of every leaf it
/// is compared with the allowed error, max(force_error |F|, force_floor). A leaf that exceeds it
/// first has its untried corners solved, including those close outside the ball. When all have been
/// tried, the leaf is split. These leaves are not split:
/// - leaves that were split scene.accuracy.levels times;
/// - leaves whose solved corners are all terminating;
/// - leaves crossed by a jump between branches (branch_check.hpp).
///
/// For a finger:
/// - Only the positions that it is pushed to (Finger::reach) by at most max_force count.
/// - Meeting the accuracy at 99 % of them is enough.
/// - A leaf with a failed corner or an apparent jump is split only once.
/// - A leaf at rest is an exception if an edge from rest ends in a failed corner. It is split even
///   if the accuracy is met elsewhere: the tissue is stiff relative to the spacing, and everything
///   that is felt lies in that leaf.
///
/// Start with few points. Refinement adds the ones that are needed to spacing = radius / 2 (33
/// points). A spacing of radius / 1 gives too little to judge by; radius / 3 already has more
/// points than many scenes need.
///
/// Deterministic; probes and attempts have no influence. Every point of the lattice must have been
/// tried: the tag unknown counts as failed. Throws if no point is solved, the scene is not
/// adaptive, or the lattice does not have lattice_divisions. Any thread.
Refinement nextRefinement(const SpaceTable& space, const Scene& scene);

}  // namespace palpate
