#pragma once

#include "viewer/fields/point_blend.hpp"
#include "viewer/fields/shape_modes.hpp"

namespace palpate {

/// The deformed shape: displacements of all visible nodes, interpolated between the configurations
/// of one space.
///
/// Interpolation is tri-linear in the leaf around a displacement (PointBlend). The shape is
/// therefore continuous over the whole ball, and its error is proportional to spacing^2.
///
/// Each shape is a linear combination of a few orthonormal *modes*, enough to reproduce every
/// coordinate of a stored shape within `largest_shape_error` (shape_modes.hpp). A corner of a leaf
/// stores one factor per mode instead of the displacements of all nodes.
///
/// float32 throughout. Copies everything, so the dataset may be destroyed. Immutable: any number of
/// threads may evaluate at the same time.
class DisplacementField {
 public:
  /// Largest error of a coordinate of a stored shape, in radii of the ball. Small enough for a
  /// drawing; forces do not depend on it.
  static constexpr double largest_shape_error = 0.002;

  /// displacements: [point][node][axis], metres, one row per point of the space's lattice; rows of
  /// unsolved points are not read. Error if no corner of a cell is solved, or if the number of
  /// values does not fit the number of lattice points.
  DisplacementField(const SpaceTable& space, std::span<const float> displacements);

  /// Fills `out` with the displacements of all nodes, [node][axis], metres, for any displacement of
  /// the active node (metres). A displacement outside the ball gives the shape at the nearest point
  /// of the ball's surface; NaN gives the shape at rest. Returns whether the displacement is in the
  /// ball and its leaf has a solved corner. Real time: does not allocate, lock, throw or log.
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
