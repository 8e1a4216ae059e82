#pragma once

#include <cstdint>
#include <vector>

#include "common/space/lattice.hpp"

namespace palpate {

/// A cube of the octree over a lattice. Its edge is divisions >> level coordinates: one spacing at
/// level 0, half of it at level 1, and so on. At level 0 `lowest` is a multiple of the divisions.
struct LatticeCell {
  LatticePoint lowest = {0, 0, 0};  ///< the corner with the smallest coordinates
  std::int32_t level = 0;
  auto operator<=>(const LatticeCell&) const = default;
};

/// The order of SpaceTable::splits: by level, then by lowest corner.
bool coarserFirst(const LatticeCell& a, const LatticeCell& b);

/// Whether a cell is among those that were split, which are in the order of coarserFirst.
bool isSplit(const std::vector<LatticeCell>& splits, const LatticeCell& cell);

/// The cell of the next coarser level around a cell of level 1 or more.
LatticeCell parentOf(const LatticeCell& cell, std::int32_t divisions);

/// A cell that reaches less deep into the ball, in radii, does not count as reaching into it: so
/// round-off does not decide about cells that touch the sphere from outside.
inline constexpr double shallow_reach = 1e-10;

/// Whether a cell reaches into the ball of the lattice.
bool reachesIntoBall(const Lattice& lattice, const LatticeCell& cell);

/// Cells of level 0 on each side of the origin, per axis, that may reach into the ball.
std::int32_t cellsPerRadius(const Lattice& lattice);

/// How many cells of level 0 reach into the ball. Costs a look at each.
std::int64_t cellsInBall(const Lattice& lattice);

}  // namespace palpate
