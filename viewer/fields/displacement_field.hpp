#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "common/space/space_table.hpp"
#include "viewer/fields/cell_field.hpp"

namespace palpate {

/// The deformed shape: displacements of all visible nodes, interpolated between the configurations
/// of one space.
///
/// Without tangents tri-linear in the leaf around; error spacing^2. With tangents du/dp tri-cubic
/// Hermite from values and slopes (mixed derivatives from the slopes of the leaf's corners); error
/// spacing^3. Tri-linear all the same in leaves with an inconsistent edge (branch_check.hpp) and
/// where levels meet, blended as CellField's limiter does. So the shape is continuous over the
/// whole ball. Corners that are not solved are continued: with tangents from the nearest solved
/// point, without linearly from the eight nearest.
///
/// float32 throughout, one row of all nodes per corner (four with tangents), so that an evaluation
/// streams eight (32) rows through the cache; everything is copied, the dataset may go. Immutable:
/// any number of threads may evaluate at once.
class DisplacementField {
 public:
  /// displacements: [point][node][axis], metres, a row per point of the space's lattice (of points
  /// that are not solved never read). tangents: [point][direction][node][axis], du/dp_direction, no
  /// unit; or empty. Error when no point is solved or the sizes do not fit together.
  DisplacementField(const SpaceTable& space, std::span<const float> displacements,
                    std::span<const float> tangents = {});

  std::size_t nodes() const { return row_ / 3; }
  bool hasTangents() const { return kinds_ > 1; }

  /// Fills `out`, [node][axis], metres, 3 nodes() long, for any displacement of the active node
  /// (metres). Outside of the ball the shape at the nearest point of the sphere, at rest for NaN.
  /// Tells whether the displacement is in the ball, with a solved corner around. Real time: does
  /// not allocate, lock, throw or log.
  bool evaluate(const Eigen::Vector3d& displacement, std::span<float> out) const noexcept;

 private:
  DisplacementField(const CellData& data, std::size_t points, std::span<const float> displacements,
                    std::span<const float> tangents);
  void copySolved(std::span<const float> displacements, std::span<const float> tangents);
  void continueGhosts(const CellData& data);
  void setFlags(const CellData& data);
  void evaluateLinear(const LeafCorners& corners, const Eigen::Vector3d& local,
                      float* out) const noexcept;
  void evaluateHermite(const LeafPlace& place, float* out) const noexcept;
  std::span<float> row(std::int32_t slot, std::size_t kind) {
    return {rows_.data() + (static_cast<std::size_t>(slot) * kinds_ + kind) * row_, row_};
  }

  CellTree tree_;
  std::size_t row_ = 0;  ///< floats per row
  std::size_t kinds_ =
      1;  ///< rows per slot: displacements, and with tangents one for each direction
  std::vector<float> rows_;   ///< [slot][kind][node][axis]
  std::vector<float> flags_;  ///< per slot: 1 where the shape is tri-linear in spite of tangents
};

}  // namespace palpate
