#pragma once

#include "common/scene/scene.hpp"
#include "common/space/space_table.hpp"

namespace palpate {

/// What an adaptive build has to do next for one configuration space.
struct Refinement {
  /// Positions to solve that are no points of the lattice yet, sorted by (squared norm,
  /// coordinates): each is to be added to it, those that then fail too. Some may lie outside of the
  /// workspace ball.
  std::vector<LatticePoint> points;
  /// Cells to split, sorted by (level, lowest): to be merged into SpaceTable::splits, together with
  /// the points.
  std::vector<LatticeCell> splits;
  /// How many points the rounds after this one are likely to ask for; a forecast, of which nothing
  /// that is built depends.
  double later = 0;
  /// Share (0..1) of the ball in which the likely force error keeps the accuracy.
  double kept = 1;
  bool empty() const { return points.empty() && splits.empty(); }
};

/// Compares the likely error of the force (a fifth of the bound of field_error.hpp) with what
/// scene.accuracy allows, max(force_error |F|, force_floor), at 125 positions of every leaf cell.
/// Where it is larger in a leaf, its corners close outside of the ball are to be solved, and when
/// all have been tried, the leaf is to be split, unless it has been split scene.accuracy.levels
/// times, its solved corners are all terminating, or a jump between branches crosses it
/// (branch_check.hpp). Empty when the accuracy is kept in 99.8 % of the ball, or cannot be
/// improved; `kept` tells these apart. Of a finger what counts of the ball is what it is pushed to
/// (Finger::reach) by forces up to max_force, and 99 % of that are enough; a leaf with a corner
/// that failed, or with what looks like a jump, is split once and no more; but a leaf at rest of
/// which an edge from there ends in a failed corner is split whatever is kept elsewhere: the tissue
/// is stiff against the spacing, and all that is felt lies between.
///
/// Start from few points: spacing = radius / 2 (33 points) is refined to what is needed; with
/// radius / 1 too little is known to judge, and radius / 3 already has more points than many scenes
/// need.
///
/// A deterministic function of its arguments; probes and attempts have no influence. Every point of
/// the lattice must have been tried: tag unknown counts as failed. Error when no point is solved,
/// when the scene is not adaptive, or when the lattice does not have lattice_divisions. Any thread.
Refinement nextRefinement(const SpaceTable& space, const Scene& scene);

}  // namespace palpate
