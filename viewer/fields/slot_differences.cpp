#include "viewer/fields/slot_differences.hpp"

#include <algorithm>
#include <limits>

namespace palpate {
namespace {

bool isSolvedSlot(const CellTree& tree, std::int32_t slot) {
  return tree.slots()[at(slot)].kind == SlotKind::solved;
}

}  // namespace

SlotDifferences::SlotDifferences(const CellData& data, Ghosts ghosts)
    : level_(data.tree.slots().size(), std::numeric_limits<std::int32_t>::max()) {
  const CellTree& tree = data.tree;
  std::int32_t deepest = 0;
  for (std::int32_t leaf = 0; leaf < std::ssize(tree.leaves()); ++leaf) {
    const std::int32_t level = tree.leaves()[at(leaf)].level;
    deepest = std::max(deepest, level);
    for (const std::int32_t slot : tree.corners(leaf))
      level_[at(slot)] = std::min(level_[at(slot)], level);
  }
  slots_.resize(at(deepest) + 1);
  hanging_.resize(at(deepest) + 1);
  for (const std::int32_t slot : tree.hangingSlots()) {
    level_[at(slot)] = tree.leaves()[at(tree.slots()[at(slot)].leaf)].level;
    hanging_[at(level_[at(slot)])].push_back(slot);
  }
  PALPATE_ASSERT(data.numbers.size() == tree.slots().size(),
                 "jumps are found by the lattice numbers of slots");
  stencils_.resize(tree.slots().size());
  for (std::size_t s = 0; s < stencils_.size(); ++s) {
    if (tree.slots()[s].kind == SlotKind::hanging) continue;
    const auto slot = static_cast<std::int32_t>(s);
    slots_[at(level_[s])].push_back(slot);
    for (std::size_t axis = 0; axis < 3; ++axis)
      stencils_[s][axis] = choose(data, slot, axis, ghosts);
  }
}

/// The nearest slot in a direction whose data exist when `level` is made; -1 for none.
std::int32_t SlotDifferences::neighbour(const CellData& data, std::int32_t slot, std::size_t axis,
                                        int direction, std::int32_t level) const {
  const CellTree& tree = data.tree;
  const std::int32_t root = data.divisions;
  // From the edge of the slot's own leaves up: the neighbour may belong to coarser ones only.
  for (std::int32_t l = level; l >= 0; --l) {
    LatticePoint point = tree.slots()[at(slot)].point;
    point[axis] += direction * (root >> l);
    const std::int32_t other = data.slotAt(point);
    if (other < 0 || level_[at(other)] > level ||
        (level_[at(other)] == level && tree.slots()[at(other)].kind == SlotKind::hanging))
      continue;
    return data.isInconsistent(slot, other) ? -1 : other;
  }
  return -1;
}

SlotDifferences::Stencil SlotDifferences::choose(const CellData& data, std::int32_t slot,
                                                 std::size_t axis, Ghosts ghosts) const {
  const CellTree& tree = data.tree;
  const std::int32_t level = level_[at(slot)];
  std::int32_t lower = neighbour(data, slot, axis, -1, level),
               upper = neighbour(data, slot, axis, 1, level);
  if (ghosts == Ghosts::if_needed && isSolvedSlot(tree, slot)) {
    const auto isGhost = [&](std::int32_t other) {
      return other >= 0 && tree.slots()[at(other)].kind == SlotKind::ghost;
    };
    if (isGhost(lower) && upper >= 0 && !isGhost(upper)) lower = -1;
    if (isGhost(upper) && lower >= 0 && !isGhost(lower)) upper = -1;
  }
  Stencil stencil;
  std::array<std::int32_t, 2> chosen = {lower, upper};
  if ((lower < 0) !=
      (upper < 0)) {  // one-sided: with the neighbour's neighbour, if that is as good
    const int direction = upper < 0 ? -1 : 1;
    const std::int32_t near = std::max(lower, upper);
    const std::int32_t far = neighbour(data, near, axis, direction, level);
    const bool usable =
        far >= 0 && (ghosts == Ghosts::any || isSolvedSlot(tree, far) || !isSolvedSlot(tree, slot));
    chosen = {near, usable ? far : -1};
  }
  for (std::size_t n = 0; n < 2; ++n) {
    if (chosen[n] < 0) continue;
    stencil.slots[n] = chosen[n];
    stencil.distances[n] = (tree.displacement(chosen[n]) - tree.displacement(slot))[axis];
  }
  return stencil;
}

}  // namespace palpate
