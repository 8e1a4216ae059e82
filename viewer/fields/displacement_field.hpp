#pragma once

#include "viewer/fields/point_blend.hpp"
#include "viewer/fields/shape_modes.hpp"

namespace palpate {

/// Displacements of all visible nodes, interpolated between the configurations of one space: the
/// deformed shape.
///
/// Tri-linear in the leaf around a displacement (PointBlend), so continuous over the whole ball;
/// the error is proportional to spacing^2.
///
/// Shapes are sums of a few orthogonal *modes*: as many as are needed to keep every coordinate of a
/// stored shape within `largest_shape_error` (shape_modes.hpp). A corner stores its share of each
/// mode instead of a row of all nodes.
///
/// float32 throughout. Copies everything, so the dataset may be destroyed. Immutable: any number of
/// threads may evaluate at the same time.
class DisplacementField {
 public:
  /// In radii of the ball. Enough for a picture; forces do not depend on it.
  static constexpr double largest_shape_error = 0.002;

  /// displacements: [point][node][axis], metres, a row per point of the space's lattice; rows of
  /// unsolved points are not read. Error if no corner of a cell is solved or the number of values
  /// does not fit.
  DisplacementField(const SpaceTable& space, std::span<const float> displacements);

  /// Fills `out`, [node][axis], metres, as long as a row, for any displacement of the active node
  /// (metres). Outside the ball it gives the shape at the nearest point of the sphere; for NaN, the
  /// shape at rest. Returns whether the displacement is in the ball, with a solved corner around
  /// it. Real time: does not allocate, lock, throw or log.
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
