#pragma once

#include <span>
#include <vector>

#include "viewer/fields/cell_data.hpp"

namespace palpate {

/// One term of a weighted sum over solved points: a point and its factor.
struct PointShare {
  std::int32_t row = -1;  ///< index in PointBlend::points
  double factor = 0;
};

/// Values of solved points, one row per point.
using PointRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Interpolation weights of the solved points of a space, for shapes, pressures and whole
/// configurations. Forces are interpolated by ForceField instead.
///
/// Interpolation is tri-linear in the leaf around a displacement. A ghost corner is extrapolated
/// from the nearest solved corners, at most 20, but only from those on the branch of the nearest.
/// The extrapolation is exact for linear functions, and nearer points weigh more. If these corners
/// do not span three dimensions, only the nearest is used. A hanging corner is interpolated in its
/// coarser leaf. Factors sum to 1; some may be negative.
///
/// Immutable: any number of threads may read at the same time.
class PointBlend {
 public:
  /// Copies the data that it needs. Error if no solved point is a corner of a cell.
  explicit PointBlend(const SpaceTable& space);

  const CellTree& tree() const { return tree_; }
  /// Indices of the solved lattice points that are corners of cells, in the order of their slots.
  const std::vector<std::int32_t>& points() const { return points_; }
  /// Returns the rows of `values`, [point of the space][node][component], that belong to points();
  /// values of other points are not read. Error if the number of values does not fit.
  PointRows rowsOf(std::span<const float> values, std::size_t components) const;

  /// Returns the shares of a slot in ascending order of rows, each row once; a solved slot has only
  /// its own row. Real time.
  const std::vector<PointShare>& ofSlot(std::int32_t slot) const { return shares_[at(slot)]; }
  /// Returns the shares at a displacement, metres, in ascending order of rows. A displacement
  /// outside the ball is replaced by the nearest point of the ball's surface, NaN by rest.
  std::vector<PointShare> sharesAt(const Eigen::Vector3d& displacement) const;
  /// Returns the leaf in which sharesAt() interpolates. Real time.
  LeafPlace leafAt(const Eigen::Vector3d& displacement) const noexcept;

 private:
  PointBlend(const CellBranches& data, std::size_t all_points);

  CellTree tree_;
  std::size_t all_points_;  ///< number of points of the space, solved or not
  std::vector<std::int32_t> points_;
  std::vector<std::vector<PointShare>> shares_;  ///< per slot
};

}  // namespace palpate
