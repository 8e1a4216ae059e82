#pragma once

#include <span>
#include <vector>

#include "viewer/fields/cell_data.hpp"

namespace palpate {

/// A multiple of what a solved point has.
struct PointShare {
  std::int32_t row = -1;  ///< of PointBlend::points
  double factor = 0;
};

/// A row per solved point, a column per number of it.
using PointRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Of which solved points of a space, and of how much of each, anything between them is made that
/// is no force: shapes, pressures, whole configurations.
///
/// Tri-linear in the leaf around a displacement. A ghost is continued from the up to 20 nearest
/// solved corners, without those on another branch than the nearest, so that linear functions are
/// exact and near points weigh more; from the nearest alone where those do not span the space. A
/// hanging corner is what its coarser leaf interpolates there. Factors sum to 1; some may be
/// negative.
///
/// Immutable: any number of threads may ask at once.
class PointBlend {
 public:
  /// Copies what it needs. Error when no point of the space, or no corner of a cell, is solved.
  explicit PointBlend(const SpaceTable& space);

  const CellTree& tree() const { return tree_; }
  /// Lattice numbers of the solved corners of cells, in the order of their slots.
  const std::vector<std::int32_t>& points() const { return points_; }
  /// Their rows of `values`, [point of the space][node][component], of which those of other points
  /// are not read. Error when the number of values does not fit.
  PointRows rowsOf(std::span<const float> values, std::size_t components) const;

  /// In ascending order of rows, each once; a solved slot is itself alone. Real time.
  const std::vector<PointShare>& ofSlot(std::int32_t slot) const { return shares_[at(slot)]; }
  /// The same for a displacement, metres. Outside of the ball those of the nearest point of the
  /// sphere, those at rest for NaN.
  std::vector<PointShare> sharesAt(const Eigen::Vector3d& displacement) const;
  /// The leaf that these are interpolated in. Real time.
  LeafPlace leafAt(const Eigen::Vector3d& displacement) const noexcept;

 private:
  PointBlend(const CellBranches& data, std::size_t all_points);

  CellTree tree_;
  std::size_t all_points_;  ///< of the space
  std::vector<std::int32_t> points_;
  std::vector<std::vector<PointShare>> shares_;  ///< per slot
};

}  // namespace palpate
