#pragma once

#include <span>
#include <vector>

#include "viewer/fields/cell_data.hpp"

namespace palpate {

/// A multiple of what a solved slot has.
struct SlotTerm {
  std::int32_t slot = -1;
  double factor = 0;
};

/// What stands in a ghost of anything that solved slots have (shapes, pressures): the sum of these.
/// Continued from the up to 20 nearest of `solved`, all solved slots, at least one, without those
/// on another branch than the nearest, so that linear functions are exact, near slots weighing
/// more; from the nearest alone where those do not span the space. Factors sum to 1.
std::vector<SlotTerm> continuedFrom(std::span<const std::int32_t> solved, const CellBranches& data,
                                    std::int32_t ghost);

/// The same for every slot of the tree: a solved one is itself, a hanging one what its coarser leaf
/// interpolates there tri-linearly. Each solved slot at most once, in ascending order. Error when
/// none is solved.
std::vector<std::vector<SlotTerm>> solvedTerms(const CellBranches& data);

}  // namespace palpate
