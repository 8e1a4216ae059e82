#include "viewer/fields/cell_data.hpp"

#include <algorithm>

namespace palpate {

std::vector<Equilibrium> slotEquilibria(const CellTree& tree, const SpaceTable& space,
                                        const std::vector<LocalPolynomial>& ghosts) {
  std::vector<Equilibrium> equilibria(tree.slots().size());
  PALPATE_ASSERT(ghosts.size() == equilibria.size(), "each corner of a cell needs a polynomial");
  for (std::size_t s = 0; s < equilibria.size(); ++s) {
    const CellSlot& slot = tree.slots()[s];
    if (slot.kind == SlotKind::solved) equilibria[s] = space.points[slot.number].equilibrium;
    if (slot.kind == SlotKind::ghost) equilibria[s] = ghosts[s].at(Eigen::Vector3d::Zero());
  }
  return equilibria;
}

std::vector<double> slotCoverage(const CellTree& tree,
                                 const std::vector<LatticeEdge>& inconsistent) {
  // The ends of an inconsistent edge are solved, but interpolation towards them mixes two branches.
  std::vector<std::int32_t> ends;
  for (const LatticeEdge& edge : inconsistent) ends.insert(ends.end(), {edge.a, edge.b});
  std::ranges::sort(ends);
  std::vector<double> coverage;
  for (const CellSlot& slot : tree.slots())
    coverage.push_back(slot.kind == SlotKind::solved &&
                       !std::ranges::binary_search(ends, slot.number));
  fillHangingTrilinearly(tree, coverage);
  return coverage;
}

CellBranches::CellBranches(const SpaceTable& space)
    : tree(space), inconsistent(inconsistentEdges(space)) {
  for (const CellSlot& slot : tree.slots())
    numbers.push_back(space.lattice.indexOf(slot.point).value_or(-1));
}

CellData::CellData(const SpaceTable& space) : CellData(space, LocalFits(space.lattice.unit())) {}

CellData::CellData(const SpaceTable& space, LocalFits&& fits) : CellData(space, fits) {}

CellData::CellData(const SpaceTable& space, LocalFits& fits)
    : CellBranches(space),
      suspect(suspectEdges(space)),
      ghosts(ghostPolynomials(tree, space, inconsistent, fits)),
      equilibria(slotEquilibria(tree, space, ghosts)),
      support(slotCoverage(tree, inconsistent)),
      divisions(space.lattice.divisions()),
      max_force(space.max_force),
      has_fibers(space.has_fibers) {}

std::int32_t CellData::slotAt(const LatticePoint& point) const {
  const std::vector<CellSlot>& slots = tree.slots();
  const auto found = std::ranges::lower_bound(slots, point, {}, &CellSlot::point);
  return found == slots.end() || found->point != point ? -1 : found - slots.begin();
}

bool CellBranches::isInconsistent(std::int32_t a, std::int32_t b) const {
  return contains(inconsistent, numbers[at(a)], numbers[at(b)]);
}

std::vector<std::int32_t> CellData::leavesWith(const std::vector<LatticeEdge>& edges) const {
  std::vector<std::int32_t> found;
  if (edges.empty()) return found;
  for (std::int32_t leaf = 0; leaf < std::ssize(tree.leaves()); ++leaf) {
    const bool any = anyEdge(tree.corners(leaf), [&](std::int32_t a, std::int32_t b) {
      return contains(edges, numbers[at(a)], numbers[at(b)]);
    });
    if (any) found.push_back(leaf);
  }
  return found;
}

}  // namespace palpate
