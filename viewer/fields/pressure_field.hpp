#pragma once

#include "viewer/fields/point_blend.hpp"

namespace palpate {

/// Pressures of all visible nodes, interpolated between the configurations of one space.
/// Displacements are interpolated in the same way (DisplacementField), so the pressures fit the
/// drawn shape.
///
/// Compression is positive. At a solved displacement the pressures are exactly the stored values,
/// because each solved slot stores its row, 4 bytes per node. Visible nodes are vertices of the
/// mesh, which have a pressure with every choice of finite elements. Mid-edge nodes are not drawn.
///
/// Immutable: any number of threads may evaluate at the same time.
class PressureField {
 public:
  /// pressures: [point][node], Pa, one row per point of the space's lattice; rows of unsolved
  /// points are not read. Error if no corner of a cell is solved, or if the number of values does
  /// not fit the number of lattice points.
  PressureField(const SpaceTable& space, std::span<const float> pressures);

  /// Adds `weight` times the pressures at a displacement of the active node (metres) to `out`,
  /// [node], Pa. A displacement outside the ball is replaced by the nearest point of the ball's
  /// surface, NaN by rest. Real time: does not allocate, lock, throw or log.
  void add(const Eigen::Vector3d& displacement, double weight, std::span<float> out) const noexcept;

 private:
  PointBlend blend_;
  PointRows rows_;
};

}  // namespace palpate
