#pragma once

#include "viewer/fields/point_blend.hpp"
#include "viewer/fields/shape_modes.hpp"

namespace palpate {

/// The deformed shape: displacements of all visible nodes, interpolated between the configurations
/// of one space.
///
/// Tri-linear in the leaf around (PointBlend), so continuous over the whole ball; error spacing^2.
///
/// Shapes are sums of a few orthogonal *modes*, as many as it takes for no coordinate of a stored
/// shape to be off by more than `largest_shape_error` (shape_modes.hpp). A corner keeps its share
/// of each, not a row of all nodes.
///
/// float32 throughout; everything is copied, the dataset may go. Immutable: any number of threads
/// may evaluate at once.
class DisplacementField {
 public:
  /// In radii of the ball: a picture needs no more, and forces do not come from here.
  static constexpr double largest_shape_error = 0.002;

  /// displacements: [point][node][axis], metres, a row per point of the space's lattice (of points
  /// that are not solved never read). Error when no corner of a cell is solved or their number does
  /// not fit.
  DisplacementField(const SpaceTable& space, std::span<const float> displacements);

  /// Fills `out`, [node][axis], metres, as long as a row, for any displacement of the active node
  /// (metres). Outside of the ball the shape at the nearest point of the sphere, at rest for NaN.
  /// Tells whether the displacement is in the ball, with a solved corner around. Real time: does
  /// not allocate, lock, throw or log.
  bool evaluate(const Eigen::Vector3d& displacement, std::span<float> out) const noexcept;

  std::size_t modeCount() const { return static_cast<std::size_t>(modes_.rows()); }

 private:
  DisplacementField(const PointBlend& blend, std::span<const float> displacements);
  void evaluateIn(const LeafPlace& place, std::span<float> out) const noexcept;

  CellTree tree_;
  ShapeRows modes_;   ///< [mode][node, axis]
  ShapeRows shares_;  ///< [slot][mode]
};

}  // namespace palpate
