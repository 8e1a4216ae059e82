#pragma once

#include <span>
#include <vector>

#include "viewer/fields/cell_data.hpp"

namespace palpate {

/// A multiple of the values of a solved point.
struct PointShare {
  std::int32_t row = -1;  ///< of PointBlend::points
  double factor = 0;
};

/// One row per solved point, one column per value of it.
using PointRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Shares of the solved points of a space in any quantity interpolated between them, except forces:
/// shapes, pressures, whole configurations.
///
/// Tri-linear in the leaf around a displacement. A ghost is extrapolated from the up to 20 nearest
/// solved corners, without those on another branch than the nearest one; linear functions are
/// exact, and nearer points weigh more. If those corners do not span the space, the nearest one
/// alone is used. A hanging corner takes the interpolant of its coarser leaf. Factors sum to 1;
/// some may be negative.
///
/// Immutable: any number of threads may read at the same time.
class PointBlend {
 public:
  /// Copies the data that it needs. Error if no point of the space, or no corner of a cell, is
  /// solved.
  explicit PointBlend(const SpaceTable& space);

  const CellTree& tree() const { return tree_; }
  /// Lattice numbers of the solved corners of cells, in the order of their slots.
  const std::vector<std::int32_t>& points() const { return points_; }
  /// Returns their rows of `values`, [point of the space][node][component]; values of other points
  /// are not read. Error if the number of values does not fit.
  PointRows rowsOf(std::span<const float> values, std::size_t components) const;

  /// Shares of a slot, each row once, in ascending order; a solved slot has only its own. Real
  /// time.
  const std::vector<PointShare>& ofSlot(std::int32_t slot) const { return shares_[at(slot)]; }
  /// Shares at a displacement, metres, in the same order. Outside the ball they are those at the
  /// nearest point of the sphere; for NaN, those at rest.
  std::vector<PointShare> sharesAt(const Eigen::Vector3d& displacement) const;
  /// Leaf in which sharesAt() interpolates. Real time.
  LeafPlace leafAt(const Eigen::Vector3d& displacement) const noexcept;

 private:
  PointBlend(const CellBranches& data, std::size_t all_points);

  CellTree tree_;
  std::size_t all_points_;  ///< of the space
  std::vector<std::int32_t> points_;
  std::vector<std::vector<PointShare>> shares_;  ///< per slot
};

}  // namespace palpate
