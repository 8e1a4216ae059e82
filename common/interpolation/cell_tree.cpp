#include "common/interpolation/cell_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"

namespace palpate {
namespace {

constexpr std::int32_t no_cell = std::numeric_limits<std::int32_t>::max();
// Distance, in radii, by which find() moves a position inward if it lies in no leaf. Such a
// position is near the sphere, in a cell that was left out because it hardly reaches into the ball
// (shallow_reach). The distance exceeds the depth to which these cells reach.
constexpr double pull = 1e-9;
static_assert(pull > shallow_reach);

LatticePoint cornerOf(const LatticeCell& cell, std::size_t corner, std::int32_t edge) {
  LatticePoint point = cell.lowest;
  for (std::size_t axis = 0; axis < 3; ++axis) point[axis] += (corner >> axis & 1) != 0 ? edge : 0;
  return point;
}

}  // namespace

CellTree::CellTree(const SpaceTable& space)
    : radius_(space.lattice.radius()),
      spacing_(space.lattice.spacing()),
      divisions_(space.lattice.divisions()),
      extent_(cellsPerRadius(space.lattice)) {
  if (!hasSolvedPoint(space))
    throw failure("active node {}: no lattice point was solved, so there is nothing to interpolate",
                  space.patch.name);
  PALPATE_ASSERT(space.points.size() == at(space.lattice.size()),
                 "each lattice point must have a record");
  const auto side = 2 * static_cast<std::size_t>(extent_);
  nodes_.assign(side * side * side, no_cell);
  std::size_t place = 0;
  for (std::int32_t i = -extent_; i < extent_; ++i)
    for (std::int32_t j = -extent_; j < extent_; ++j)
      for (std::int32_t k = -extent_; k < extent_; ++k)
        addCell(space, {{i * divisions_, j * divisions_, k * divisions_}, 0}, place++);
  PALPATE_ASSERT(!leaves_.empty(), "some cell must lie in the ball of displacements");
  makeSlots(space);
  markUnsupported();
}

void CellTree::addCell(const SpaceTable& space, const LatticeCell& cell, std::size_t place) {
  if (!reachesIntoBall(space.lattice, cell)) return;
  const std::int32_t half = divisions_ >> (cell.level + 1);
  if (half == 0 || !isSplit(space.splits, cell)) {
    nodes_[place] = static_cast<std::int32_t>(leaves_.size());
    leaves_.push_back(cell);
    return;
  }
  // Append the entries of all eight children before any child appends entries for its own children.
  const std::size_t children = nodes_.size();
  nodes_[place] = ~static_cast<std::int32_t>(children);
  nodes_.resize(children + 8, no_cell);
  for (std::size_t c = 0; c < 8; ++c)
    addCell(space, {cornerOf(cell, c, half), cell.level + 1}, children + c);
}

void CellTree::makeSlots(const SpaceTable& space) {
  std::vector<LatticePoint> points;
  const auto eachCorner = [this](auto visit) {
    for (std::size_t leaf = 0; leaf < leaves_.size(); ++leaf)
      for (std::size_t c = 0; c < 8; ++c)
        visit(leaf, c, cornerOf(leaves_[leaf], c, divisions_ >> leaves_[leaf].level));
  };
  eachCorner([&](std::size_t, std::size_t, const LatticePoint& point) { points.push_back(point); });
  std::ranges::sort(points);
  points.erase(std::unique(points.begin(), points.end()), points.end());

  const std::vector<bool> interpolated = interpolatedPoints(space);
  for (const LatticePoint& point : points) {
    CellSlot slot;
    slot.point = point;
    const auto number = space.lattice.indexOf(point);
    if (number && interpolated[at(*number)]) {
      slot.kind = SlotKind::solved;
      slot.number = *number;
    }
    // Call hang() last, because a slot can be hanging even if its position is solved.
    hang(slot);
    if (slot.kind == SlotKind::hanging)
      hanging_.push_back(static_cast<std::int32_t>(slots_.size()));
    slots_.push_back(slot);
  }
  corners_.resize(leaves_.size());
  eachCorner([&](std::size_t leaf, std::size_t c, const LatticePoint& point) {
    corners_[leaf][c] = static_cast<std::int32_t>(
        std::lower_bound(points.begin(), points.end(), point) - points.begin());
  });
  const auto level = [this](std::int32_t slot) {
    return leaves_[at(slots_[at(slot)].place.leaf)].level;
  };
  std::ranges::stable_sort(hanging_, {}, level);
}

/// Makes a slot hanging in the coarsest of the up to eight leaves that touch it, unless it is a
/// corner of that leaf.
void CellTree::hang(CellSlot& slot) const {
  LeafPlace coarsest;
  for (std::size_t octant = 0; octant < 8; ++octant) {
    const LeafPlace place = leafBeside(slot.point, octant);
    if (place.leaf >= 0 &&
        (coarsest.leaf < 0 || leaves_[at(place.leaf)].level < leaves_[at(coarsest.leaf)].level))
      coarsest = place;
  }
  PALPATE_ASSERT(coarsest.leaf >= 0, "every corner must belong to a cell");
  if (isCorner(coarsest.local)) return;
  slot.kind = SlotKind::hanging;
  slot.number = -1;
  slot.place = coarsest;
}

LeafPlace CellTree::leafBeside(const LatticePoint& point, std::size_t octant) const noexcept {
  // A position in the octant, a quarter of a coordinate unit from the point along each axis, given
  // in quarters of a unit.
  Eigen::Vector3d beside;
  for (std::size_t axis = 0; axis < 3; ++axis)
    beside[static_cast<Eigen::Index>(axis)] =
        4.0 * point[axis] + ((octant >> axis & 1) != 0 ? 1 : -1);
  LeafPlace place = descend(beside / (4.0 * divisions_));
  if (place.leaf < 0) return place;
  const LatticeCell& cell = leaves_[at(place.leaf)];
  const double edge = divisions_ >> cell.level;
  for (std::size_t axis = 0; axis < 3; ++axis)
    place.local[static_cast<Eigen::Index>(axis)] = (point[axis] - cell.lowest[axis]) / edge;
  return place;
}

void CellTree::markUnsupported() {
  std::vector<bool> supported(slots_.size());
  for (std::size_t s = 0; s < slots_.size(); ++s) supported[s] = slots_[s].kind == SlotKind::solved;
  const auto any = [&](std::int32_t leaf) {
    const LeafCorners& c = corners(leaf);
    return std::ranges::any_of(c, [&](std::int32_t slot) { return supported[at(slot)]; });
  };
  fillHanging(*this, supported,
              [&](std::int32_t leaf, const Eigen::Vector3d&) { return any(leaf); });
  for (std::size_t leaf = 0; leaf < leaves_.size(); ++leaf)
    unsupported_.push_back(!any(static_cast<std::int32_t>(leaf)));
}

Eigen::Vector3d CellTree::displacement(std::int32_t slot) const {
  const LatticePoint& p = slots_[at(slot)].point;
  return spacing_ / divisions_ * Eigen::Vector3d(p[0], p[1], p[2]);
}

LeafPlace CellTree::descend(const Eigen::Vector3d& in_spacings) const noexcept {
  LeafPlace place;
  std::size_t node = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double x = in_spacings[axis] + extent_;
    if (!(x >= 0 && x < 2.0 * extent_)) return place;
    const auto root = static_cast<std::size_t>(x);
    node = node * 2 * static_cast<std::size_t>(extent_) + root;
    place.local[axis] = x - static_cast<double>(root);
  }
  while (nodes_[node] < 0) {
    std::size_t child = 0;
    for (int axis = 0; axis < 3; ++axis) {
      // These operations are exact in floating point, so no position falls between two leaves.
      const bool upper = place.local[axis] >= 0.5;
      child |= static_cast<std::size_t>(upper) << axis;
      place.local[axis] = 2 * place.local[axis] - (upper ? 1 : 0);
    }
    node = at(~nodes_[node]) + child;
  }
  if (nodes_[node] != no_cell) place.leaf = nodes_[node];
  return place;
}

LeafPlace CellTree::find(const Eigen::Vector3d& displacement) const noexcept {
  const double length = displacement.norm();
  if (!(length <= radius_ * (1 + pull))) return {};
  LeafPlace place = descend(displacement / spacing_);
  if (place.leaf >= 0) return place;
  LeafPlace pulled =
      descend(displacement * ((1 - pull) * std::min(1.0, radius_ / length) / spacing_));
  if (pulled.leaf < 0) return pulled;
  const LatticePoint& low = leaves_[at(pulled.leaf)].lowest;
  const Eigen::Vector3d from = displacement - unit() * Eigen::Vector3d(low[0], low[1], low[2]);
  pulled.local = (from / edge(pulled.leaf)).cwiseMax(0).cwiseMin(1);
  return pulled;
}

Eigen::Vector3d nearestInBall(const Eigen::Vector3d& displacement, double radius) noexcept {
  const double largest = displacement.cwiseAbs().maxCoeff();
  if (!(displacement.array().isNaN().any() || std::isinf(largest))) {
    const double length = displacement.stableNorm();
    if (length <= radius) return displacement;
    // Divide by the largest component first, because the norm of huge numbers could overflow.
    return displacement / largest * (radius / (displacement / largest).norm());
  }
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    if (std::isnan(displacement[axis])) return Eigen::Vector3d::Zero();
    if (std::isinf(displacement[axis])) direction[axis] = displacement[axis] > 0 ? 1 : -1;
  }
  return direction * (radius / direction.norm());
}

}  // namespace palpate
