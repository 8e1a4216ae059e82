#include "viewer/cell_grid.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"

namespace palpate {
namespace {

// In cells. A lattice point's displacement divided by the spacing is an integer to a few ulps only.
constexpr double face_tolerance = 1e-9;

int largestCoordinate(const Lattice& lattice) {
  int largest = 0;
  for (std::int32_t n = 0; n < lattice.size(); ++n)
    largest = std::max(largest, std::abs(lattice.point(n)[0]));
  return largest;
}

}  // namespace

CellGrid::CellGrid(const SpaceTable& space)
    : spacing_(space.lattice.spacing()),
      extent_(largestCoordinate(space.lattice)),
      cells_(2 * static_cast<std::size_t>(extent_)),
      solved_((cells_ + 1) * (cells_ + 1) * (cells_ + 1), -1),
      covered_(cells_ * cells_ * cells_, -1),
      nearest_(covered_.size(), -1) {
  const Lattice& lattice = space.lattice;
  bool any_solved = false;
  for (std::int32_t n = 0; n < lattice.size(); ++n) {
    if (!isSolved(space.points[n].tag)) continue;
    any_solved = true;
    const LatticePoint& p = lattice.point(n);
    solved_[pointIndex({p[0] + extent_, p[1] + extent_, p[2] + extent_})] = n;
  }
  if (!any_solved)
    throw failure("active node {}: no lattice point was solved, so there is nothing to interpolate",
                  space.patch.name);
  const int n = static_cast<int>(cells_);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) fill(lattice, {i, j, k});
  for (bool changed = true; changed;) {
    changed = sweep(lattice, 1);
    changed |= sweep(lattice, -1);
  }
}

void CellGrid::fill(const Lattice& lattice, const Cell& cell) {
  CellCorners corners{};
  for (int c = 0; c < 8; ++c)
    corners[static_cast<std::size_t>(c)] =
        solved_[pointIndex({cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2)})];
  for (const std::int32_t corner : corners) offer(lattice, cell, corner);
  if (std::find(corners.begin(), corners.end(), -1) != corners.end()) return;
  covered_[cellIndex(cell)] = static_cast<std::int32_t>(corners_.size());
  corners_.push_back(corners);
}

bool CellGrid::offer(const Lattice& lattice, const Cell& cell, std::int32_t candidate) {
  std::int32_t& nearest = nearest_[cellIndex(cell)];
  if (candidate < 0 || candidate == nearest) return false;
  const auto distance = [&](std::int32_t number) {  // squared, of the centre, in half cells
    const LatticePoint& p = lattice.point(number);
    LatticePoint step;
    for (std::size_t axis = 0; axis < 3; ++axis) step[axis] = 2 * (p[axis] + extent_ - cell[axis]) - 1;
    return squaredNorm(step);
  };
  if (nearest >= 0 && distance(candidate) >= distance(nearest)) return false;
  nearest = candidate;
  return true;
}

/// Offers to every cell what its 13 neighbours before it have, in ascending (1) or descending (-1) order.
bool CellGrid::sweep(const Lattice& lattice, int direction) {
  bool changed = false;
  const int n = static_cast<int>(cells_);
  const auto inside = [n](int coordinate) { return coordinate >= 0 && coordinate < n; };
  for (int index = 0; index < n * n * n; ++index) {
    const int at = direction > 0 ? index : n * n * n - 1 - index;
    const Cell cell = {at / (n * n), at / n % n, at % n};
    for (int step = 1; step <= 13; ++step) {  // 13 + step in base 3 is a neighbour's offset plus 1
      const Cell neighbour = {cell[0] - direction * ((13 + step) / 9 - 1),
                              cell[1] - direction * ((13 + step) / 3 % 3 - 1),
                              cell[2] - direction * ((13 + step) % 3 - 1)};
      if (std::all_of(neighbour.begin(), neighbour.end(), inside))
        changed |= offer(lattice, cell, nearest_[cellIndex(neighbour)]);
    }
  }
  return changed;
}

CellPlace CellGrid::find(const Eigen::Vector3d& displacement) const noexcept {
  CellPlace place;
  Cell cell{};
  bool in_cube = true;
  for (int axis = 0; axis < 3; ++axis) {
    const double x = displacement[axis] / spacing_ + extent_;
    const double last = static_cast<double>(cells_) - 1;
    const double low = x > 0 ? std::min(std::floor(x), last) : 0;  // 0 for NaN too
    cell[static_cast<std::size_t>(axis)] = static_cast<int>(low);
    const double local = x - low;
    in_cube = in_cube && local >= -face_tolerance && local <= 1 + face_tolerance;
    place.local[axis] = local;
  }
  const std::size_t index = cellIndex(cell);
  if (in_cube && (covered_[index] >= 0 || findTouching(cell, place))) {
    if (place.corners == nullptr) place.corners = &corners_[static_cast<std::size_t>(covered_[index])];
    place.local = place.local.cwiseMax(0).cwiseMin(1);
    return place;
  }
  place.nearest = nearestTo(cell, place.local);
  place.local.setZero();
  return place;
}

std::int32_t CellGrid::nearestTo(const Cell& cell, const Eigen::Vector3d& local) const noexcept {
  Cell corner = cell;
  for (int axis = 0; axis < 3; ++axis) corner[static_cast<std::size_t>(axis)] += local[axis] > 0.5 ? 1 : 0;
  const std::int32_t number = solved_[pointIndex(corner)];
  return number >= 0 ? number : nearest_[cellIndex(cell)];
}

/// For a displacement on the boundary of a cell that is not covered: takes a covered cell that shares that
/// boundary.
bool CellGrid::findTouching(const Cell& cell, CellPlace& place) const noexcept {
  for (int c = 1; c < 8; ++c) {
    Cell other = cell;
    Eigen::Vector3d local = place.local;
    bool touches = true;
    for (int axis = 0; axis < 3; ++axis) {
      if ((c >> axis & 1) == 0) continue;
      const bool low = local[axis]<face_tolerance, high = local[axis]> 1 - face_tolerance;
      int& coordinate = other[static_cast<std::size_t>(axis)];
      coordinate += low ? -1 : 1;
      local[axis] = low ? 1 : 0;
      touches = touches && (low || high) && coordinate >= 0 && coordinate < static_cast<int>(cells_);
    }
    if (!touches || covered_[cellIndex(other)] < 0) continue;
    place.local = local;
    place.corners = &corners_[static_cast<std::size_t>(covered_[cellIndex(other)])];
    return true;
  }
  return false;
}

}  // namespace palpate
