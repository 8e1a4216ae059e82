#pragma once

#include "viewer/fields/point_blend.hpp"

namespace palpate {

/// Pressures of all visible nodes, interpolated between the configurations of one space.
/// DisplacementField interpolates displacements in the same way, so the pressures belong to the
/// drawn shape.
///
/// Compression is positive. At the configurations themselves the pressures are the stored values to
/// the last bit: each solved slot keeps its row, 4 bytes a node. Visible nodes are vertices, which
/// have a pressure with every pair of spaces. Mid-edge nodes are not drawn; between vertices a
/// picture takes the mean.
///
/// Immutable: any number of threads may evaluate at the same time.
class PressureField {
 public:
  /// pressures: [point][node], Pa, a row per point of the space's lattice; rows of unsolved points
  /// are not read. Error if no corner of a cell is solved or the number of values does not fit.
  PressureField(const SpaceTable& space, std::span<const float> pressures);

  /// Adds `weight` times the pressures at a displacement of the active node (metres) to `out`,
  /// [node], Pa, as long as a row. Outside the ball it takes the pressures at the nearest point of
  /// the sphere; for NaN, those at rest. Real time: does not allocate, lock, throw or log.
  void add(const Eigen::Vector3d& displacement, double weight, std::span<float> out) const noexcept;

 private:
  PointBlend blend_;
  PointRows rows_;
};

}  // namespace palpate
