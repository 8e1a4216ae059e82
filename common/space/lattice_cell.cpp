#include "common/space/lattice_cell.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace palpate {

bool coarserFirst(const LatticeCell& a, const LatticeCell& b) {
  return std::tie(a.level, a.lowest) < std::tie(b.level, b.lowest);
}

bool isSplit(const std::vector<LatticeCell>& splits, const LatticeCell& cell) {
  return std::binary_search(splits.begin(), splits.end(), cell, coarserFirst);
}

LatticeCell parentOf(const LatticeCell& cell, std::int32_t divisions) {
  LatticeCell parent = {cell.lowest, cell.level - 1};
  const std::int32_t edge = divisions >> parent.level;
  for (std::int32_t& coordinate : parent.lowest) coordinate -= (coordinate % edge + edge) % edge;
  return parent;
}

bool reachesIntoBall(const Lattice& lattice, const LatticeCell& cell) {
  const std::int32_t edge = lattice.divisions() >> cell.level;
  double squared = 0;  // of the distance of the nearest place of the cell
  for (const std::int32_t low : cell.lowest) {
    const double distance = std::max({low, -(low + edge), 0});
    squared += distance * distance;
  }
  const double limit =
      lattice.radius() / lattice.spacing() * lattice.divisions() * (1 - shallow_reach);
  return squared < limit * limit;
}

std::int32_t cellsPerRadius(const Lattice& lattice) {
  return static_cast<std::int32_t>(
      std::ceil(lattice.radius() / lattice.spacing() * (1 - shallow_reach)));
}

std::int64_t cellsInBall(const Lattice& lattice) {
  const std::int32_t extent = cellsPerRadius(lattice), edge = lattice.divisions();
  std::int64_t count = 0;
  for (std::int32_t i = -extent; i < extent; ++i)
    for (std::int32_t j = -extent; j < extent; ++j)
      for (std::int32_t k = -extent; k < extent; ++k)
        count += reachesIntoBall(lattice, {{i * edge, j * edge, k * edge}, 0}) ? 1 : 0;
  return count;
}

}  // namespace palpate
