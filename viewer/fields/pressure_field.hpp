#pragma once

#include "viewer/fields/point_blend.hpp"

namespace palpate {

/// The pressures of all visible nodes, interpolated between the configurations of one space as
/// DisplacementField interpolates their displacements: what is seen has the pressures of its shape.
///
/// Positive is compression. In the configurations themselves they are the stored values to the last
/// bit: each solved slot keeps its row, 4 bytes a node. Visible nodes are vertices, which have a
/// pressure with every pair of spaces; nothing is drawn of mid-edge nodes, and between vertices a
/// picture takes the mean.
///
/// Immutable: any number of threads may evaluate at once.
class PressureField {
 public:
  /// pressures: [point][node], Pa, a row per point of the space's lattice (of points that are not
  /// solved never read). Error when no corner of a cell is solved or their number does not fit.
  PressureField(const SpaceTable& space, std::span<const float> pressures);

  /// Adds `weight` times the pressures at a displacement of the active node (metres) to `out`,
  /// [node], Pa, as long as a row. Outside of the ball those at the nearest point of the sphere,
  /// those at rest for NaN. Real time: does not allocate, lock, throw or log.
  void add(const Eigen::Vector3d& displacement, double weight, std::span<float> out) const noexcept;

 private:
  PointBlend blend_;
  PointRows rows_;
};

}  // namespace palpate
