#pragma once

#include <vector>

#include "common/dataset.hpp"
#include "common/scene.hpp"

namespace palpate {

/// What an adaptive build has to do next for one configuration space.
struct Refinement {
  /// Positions to solve that are no points of the lattice yet, sorted by (squared norm, coordinates): each is
  /// to be added to it, those that then fail too. Some may lie outside of the workspace ball.
  std::vector<LatticePoint> points;
  /// Cells to split, sorted by (level, lowest): to be merged into SpaceTable::splits, together with the
  /// points.
  std::vector<LatticeCell> splits;
  /// Largest estimated force error over what Accuracy allows there, over the whole ball; at most 1: the
  /// estimate keeps the accuracy everywhere.
  double worst_ratio = 0;
  /// Share (0..1) of sampled positions of the ball at which the estimate keeps the accuracy.
  double kept = 1;
  bool empty() const { return points.empty() && splits.empty(); }
};

/// Compares the estimated error of the force (field_error.hpp) with what scene.accuracy allows,
/// max(force_error |F|, force_floor), at sample positions of every leaf cell. Where it is larger, corners of
/// the leaf that were never tried are to be solved, and when there are none, the leaf is to be split, unless
/// it has been split scene.accuracy.levels times or its solved corners are all terminating. Empty when the
/// accuracy is kept or cannot be improved; worst_ratio tells these apart.
///
/// A deterministic function of its arguments; probes and attempts have no influence. Every point of the
/// lattice must have been tried: tag unknown counts as failed. Error when no point is solved, or when
/// the scene is not adaptive or the lattice lacks lattice_divisions. Any thread.
Refinement nextRefinement(const SpaceTable& space, const Scene& scene);

}  // namespace palpate
