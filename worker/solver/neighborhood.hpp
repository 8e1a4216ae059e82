#pragma once

#include "worker/solver/element_batches.hpp"
#include "worker/solver/linear_solver.hpp"

namespace palpate {

/// The unknowns of some nodes around a rigid tool, with the elements they occur in: what System
/// needs to assemble the equations of these unknowns while all others are held. Valid for the tool
/// and the System it was made for.
struct Neighborhood {
  struct Entry {
    std::int32_t number;       ///< of SparsityPattern
    std::int32_t row, column;  ///< of the small matrix, row <= column
  };
  std::vector<std::int32_t> unknowns;  ///< ascending
  std::vector<std::int32_t> batches;   ///< ascending, indices into ElementBatches::all
  std::vector<Entry> entries;
};

/// The neighbourhood of the `count` nodes nearest to those that the tool holds, or of all there
/// are.
Neighborhood neighborhoodOf(const std::vector<std::int32_t>& tool_nodes, std::size_t count,
                            const Mesh& mesh, const Unknowns& unknowns,
                            const ElementBatches& batches, const SparsityPattern& pattern);

}  // namespace palpate
