#pragma once

#include <span>

#include "viewer/fields/cell_data.hpp"

namespace palpate {

/// The deformed shape: displacements of all visible nodes, interpolated between the configurations
/// of one space.
///
/// Tri-linear in the leaf around, so continuous over the whole ball; error spacing^2. Corners that
/// are not solved are continued from the up to 20 nearest that are, so that linear motions are
/// exact, or from the nearest alone where those do not span the space.
///
/// float32 throughout, one row of all nodes per corner, so that an evaluation streams eight rows
/// through the cache; everything is copied, the dataset may go. Immutable: any number of threads
/// may evaluate at once.
class DisplacementField {
 public:
  /// displacements: [point][node][axis], metres, a row per point of the space's lattice (of points
  /// that are not solved never read). Error when no corner of a cell is solved or their number does
  /// not fit.
  DisplacementField(const SpaceTable& space, std::span<const float> displacements);

  /// Fills `out`, [node][axis], metres, as long as a row, for any displacement of the active node
  /// (metres). Outside of the ball the shape at the nearest point of the sphere, at rest for NaN.
  /// Tells whether the displacement is in the ball, with a solved corner around. Real time: does
  /// not allocate, lock, throw or log.
  bool evaluate(const Eigen::Vector3d& displacement, std::span<float> out) const noexcept;

 private:
  DisplacementField(const CellBranches& data, std::size_t points,
                    std::span<const float> displacements);
  void continueGhost(const CellBranches& data, std::int32_t ghost);
  void evaluateIn(const LeafPlace& place, float* out) const noexcept;
  float* row(std::int32_t slot) { return rows_.data() + at(slot) * row_; }

  CellTree tree_;
  std::size_t row_ = 0;      ///< floats per row
  std::vector<float> rows_;  ///< [slot][node][axis]
};

}  // namespace palpate
