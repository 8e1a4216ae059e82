#include "common/interpolation/branch_check.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

/// The cells of the octree that refinement did not split.
struct Leaves {
  const std::vector<LatticeCell>& splits;
  std::int32_t divisions;

  std::int32_t edge(std::int32_t level) const { return divisions >> level; }
  std::int32_t deepest() const { return splits.empty() ? 0 : splits.back().level + 1; }
  bool isLeaf(const LatticeCell& cell) const {
    return !isSplit(splits, cell) &&
           (cell.level == 0 || isSplit(splits, parentOf(cell, divisions)));
  }
};

bool isMultiple(const LatticePoint& point, std::int32_t of) {
  return std::ranges::all_of(point, [of](std::int32_t x) { return x % of == 0; });
}

/// Returns whether one of the four cells around the edge from `lower` along `axis` is a leaf.
bool bordersLeaf(const Leaves& leaves, const LatticePoint& lower, std::size_t axis,
                 std::int32_t level) {
  for (int around = 0; around < 4; ++around) {
    LatticeCell cell{lower, level};
    if ((around & 1) != 0) cell.lowest[(axis + 1) % 3] -= leaves.edge(level);
    if ((around & 2) != 0) cell.lowest[(axis + 2) % 3] -= leaves.edge(level);
    if (leaves.isLeaf(cell)) return true;
  }
  return false;
}

/// N, largest force in the measurements from which the thresholds were chosen. If the largest force
/// of a space is smaller, the thresholds in newtons are reduced in proportion.
constexpr double measured_force = 3.3;

double largestForce(const Lattice& lattice, const EquilibriumOf& equilibriumOf) {
  double largest = 0;
  for (std::int32_t n = 0; n < lattice.size(); ++n)
    if (const ToolEquilibrium* const here = equilibriumOf(n))
      largest = std::max(largest, here->force.norm());
  return largest;
}

/// Returns the edges of leaf cells that join solved points and have an EdgeCheck for which
/// `selects` is true.
template <class Select>
std::vector<LatticeEdge> selectEdges(const Lattice& lattice, const std::vector<LatticeCell>& splits,
                                     const EquilibriumOf& equilibriumOf, Select selects) {
  const Leaves leaves = {splits, lattice.divisions()};
  const double largest_force = largestForce(lattice, equilibriumOf);
  std::vector<LatticeEdge> found;
  for (std::int32_t n = 0; n < lattice.size(); ++n) {
    const ToolEquilibrium* const here = equilibriumOf(n);
    if (here == nullptr) continue;
    for (std::int32_t level = 0; level <= leaves.deepest(); ++level) {
      // Edges of cells of this level start only at multiples of the cells' edge.
      if (!isMultiple(lattice.point(n), leaves.edge(level))) continue;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        LatticePoint upper = lattice.point(n);
        upper[axis] += leaves.edge(level);
        const auto other = lattice.indexOf(upper);
        const ToolEquilibrium* const there = other ? equilibriumOf(*other) : nullptr;
        if (there == nullptr || !bordersLeaf(leaves, lattice.point(n), axis, level)) continue;
        if (selects(checkEdge(*here, *there, lattice.displacement(*other) - lattice.displacement(n),
                              largest_force)))
          found.push_back({std::min(n, *other), std::max(n, *other)});
      }
    }
  }
  std::ranges::sort(found);
  return found;
}

template <class Select>
std::vector<LatticeEdge> selectEdges(const SpaceTable& space, Select selects) {
  PALPATE_ASSERT(space.points.size() == static_cast<std::size_t>(space.lattice.size()),
                 "each lattice point must have a record");
  const auto equilibriumOf = [&](std::int32_t n) -> const ToolEquilibrium* {
    const PointRecord& point = space.points[static_cast<std::size_t>(n)];
    return isSolved(point.tag) ? &point.equilibrium : nullptr;
  };
  return selectEdges(space.lattice, space.splits, equilibriumOf, selects);
}

constexpr auto is_inconsistent = [](const EdgeCheck& check) { return !check.consistent(); };

}  // namespace

bool EdgeCheck::consistent() const {
  // Without the constant terms, round-off could make an edge inconsistent, even one along which the
  // force is linear.
  return force_mismatch <= 2e-3 * scale + 0.1 * change + bend &&
         energy_mismatch <= 5e-4 * scale + 0.02 * change + 0.25 * bend;
}

bool EdgeCheck::suspect() const {
  return !consistent() || force_mismatch > 0.05 * scale + 0.5 * change ||
         energy_mismatch > 0.01 * scale + 0.08 * change;
}

EdgeCheck checkEdge(const ToolEquilibrium& a, const ToolEquilibrium& b, const Eigen::Vector3d& step,
                    double largest_force) {
  const Eigen::Vector3d at_a = a.stiffness * step, at_b = b.stiffness * step, bend = at_b - at_a;
  // Corrected trapezoidal rule for the work of the force, with its slopes at both ends.
  const double work = 0.5 * (a.force + b.force).dot(step) - bend.dot(step) / 12;
  return {.force_mismatch = (b.force - a.force - 0.5 * (at_a + at_b)).norm(),
          .energy_mismatch = std::abs(b.energy - a.energy + work) / step.norm(),
          .change = 0.5 * (at_a.norm() + at_b.norm()),
          .bend = bend.norm(),
          .scale = std::min(1.0, largest_force / measured_force)};
}

std::vector<LatticeEdge> inconsistentEdges(const SpaceTable& space) {
  return selectEdges(space, is_inconsistent);
}

std::vector<LatticeEdge> inconsistentEdges(const Lattice& lattice,
                                           const std::vector<LatticeCell>& splits,
                                           const EquilibriumOf& equilibriumOf) {
  return selectEdges(lattice, splits, equilibriumOf, is_inconsistent);
}

std::vector<LatticeEdge> suspectEdges(const SpaceTable& space) {
  return selectEdges(space, [](const EdgeCheck& check) { return check.suspect(); });
}

}  // namespace palpate
