#include "viewer/fields/slot_equilibria.hpp"

#include <algorithm>

#include "common/base/index.hpp"
#include "common/interpolation/energy_jets.hpp"

namespace palpate {

std::vector<Equilibrium> slotEquilibria(const CellTree& tree, const SpaceTable& space,
                                        const std::vector<LatticeEdge>& inconsistent) {
  std::vector<Equilibrium> equilibria(tree.slots().size());
  const std::vector<LocalPolynomial> ghosts = ghostPolynomials(tree, space, inconsistent);
  for (std::size_t s = 0; s < equilibria.size(); ++s) {
    const CellSlot& slot = tree.slots()[s];
    if (slot.kind == SlotKind::solved) equilibria[s] = space.points[slot.number].equilibrium;
    if (slot.kind == SlotKind::ghost) equilibria[s] = ghosts[s].at(Eigen::Vector3d::Zero());
  }
  return equilibria;
}

std::vector<double> slotCoverage(const CellTree& tree,
                                 const std::vector<LatticeEdge>& inconsistent) {
  std::vector<std::int32_t> ends;
  for (const LatticeEdge& edge : inconsistent) ends.insert(ends.end(), {edge.a, edge.b});
  std::sort(ends.begin(), ends.end());
  std::vector<double> coverage;
  for (const CellSlot& slot : tree.slots())
    coverage.push_back(slot.kind == SlotKind::solved &&
                               !std::binary_search(ends.begin(), ends.end(), slot.number)
                           ? 1
                           : 0);
  fillHanging(tree, coverage, [&](std::int32_t leaf, const Eigen::Vector3d& local) {
    const std::array<double, 8> weights = trilinearWeights(local);
    double sum = 0;
    for (std::size_t c = 0; c < 8; ++c) sum += weights[c] * coverage[at(tree.corners(leaf)[c])];
    return sum;
  });
  return coverage;
}

}  // namespace palpate
