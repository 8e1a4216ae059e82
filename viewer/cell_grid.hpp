#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "common/dataset.hpp"
#include "common/lattice.hpp"

namespace palpate {

/// The eight lattice points around a displacement. Corner c has offset (c & 1, c >> 1 & 1, c >> 2 & 1).
using CellCorners = std::array<std::int32_t, 8>;

/// Where a displacement lies.
struct CellPlace {
  const CellCorners* corners = nullptr;             ///< lattice numbers; null when the cell is not covered
  Eigen::Vector3d local = Eigen::Vector3d::Zero();  ///< 0..1 in the cell, when covered
  std::int32_t nearest = 0;  ///< a solved lattice point close by, when not covered: the corner
                             ///< nearest to the displacement or, that unsolved, the cell
};

/// The cubes between lattice points, found in constant time. A cell is covered when its 8 corners are solved
/// (expandable or terminating); a displacement is covered when it lies in a covered cell, faces, edges and
/// corners included. Immutable after construction: any thread may read.
class CellGrid {
 public:
  /// Error when no point of the space is solved.
  explicit CellGrid(const SpaceTable& space);

  /// Real time: does not allocate, lock, throw or log. Displacements that are not finite are not covered.
  CellPlace find(const Eigen::Vector3d& displacement) const noexcept;

  double spacing() const { return spacing_; }  ///< metres
  std::size_t coveredCells() const { return corners_.size(); }

 private:
  using Cell = std::array<int, 3>;  ///< coordinates of the corner with the lowest ones, from 0
  static std::size_t index(const Cell& at, std::size_t side) {
    return (static_cast<std::size_t>(at[0]) * side + static_cast<std::size_t>(at[1])) * side +
           static_cast<std::size_t>(at[2]);
  }
  std::size_t cellIndex(const Cell& cell) const { return index(cell, cells_); }
  std::size_t pointIndex(const Cell& point) const { return index(point, cells_ + 1); }
  void fill(const Lattice& lattice, const Cell& cell);
  /// Makes `candidate` the nearest point of the cell if it is; tells whether it is. -1 is nobody.
  bool offer(const Lattice& lattice, const Cell& cell, std::int32_t candidate);
  bool sweep(const Lattice& lattice, int direction);
  std::int32_t nearestTo(const Cell& cell, const Eigen::Vector3d& local) const noexcept;
  bool findTouching(const Cell& cell, CellPlace& place) const noexcept;

  double spacing_;
  int extent_;                         ///< largest lattice coordinate
  std::size_t cells_;                  ///< per axis
  std::vector<std::int32_t> solved_;   ///< lattice number per point of the cube, -1 when not solved
  std::vector<std::int32_t> covered_;  ///< index into corners_ per cell, -1 when not covered
  std::vector<std::int32_t> nearest_;  ///< solved lattice point close to the centre, per cell
  std::vector<CellCorners> corners_;
};

}  // namespace palpate
