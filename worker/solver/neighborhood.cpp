#include <limits>
#include <utility>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "common/mesh/node_set.hpp"
#include "worker/solver/system.hpp"

namespace palpate {
namespace {

/// Returns the `count` nodes outside the tool that are nearest to it, nearest first. Equally
/// distant nodes are in ascending order.
std::vector<std::int32_t> nearestNodes(const Mesh& mesh,
                                       const std::vector<std::int32_t>& tool_nodes,
                                       std::size_t count) {
  std::vector<std::pair<double, std::int32_t>> by_distance;
  for (std::int32_t node = 0; at(node) < mesh.nodes.size(); ++node) {
    double distance = std::numeric_limits<double>::infinity();
    for (const std::int32_t held : tool_nodes)
      distance = std::min(distance, (mesh.nodes[node] - mesh.nodes[held]).squaredNorm());
    if (distance > 0) by_distance.emplace_back(distance, node);
  }
  count = std::min(count, by_distance.size());
  std::partial_sort(by_distance.begin(), by_distance.begin() + static_cast<std::ptrdiff_t>(count),
                    by_distance.end());
  std::vector<std::int32_t> nodes;
  for (std::size_t n = 0; n < count; ++n) nodes.push_back(by_distance[n].second);
  return nodes;
}

/// Returns the entries of `pattern` whose row and column are both in `unknowns` (ascending).
std::vector<Neighborhood::Entry> entriesAmong(const std::vector<std::int32_t>& unknowns,
                                              const SparsityPattern& pattern) {
  std::vector<Neighborhood::Entry> entries;
  for (std::int32_t row = 0; at(row) < unknowns.size(); ++row)
    for (std::int32_t number = pattern.row_begin[unknowns[row]];
         number < pattern.row_begin[unknowns[row] + 1]; ++number) {
      const std::int32_t unknown = pattern.column[number] - 1;
      const auto found = std::lower_bound(unknowns.begin(), unknowns.end(), unknown);
      if (found != unknowns.end() && *found == unknown)
        entries.push_back({number, row, static_cast<std::int32_t>(found - unknowns.begin())});
    }
  return entries;
}

}  // namespace

Neighborhood System::neighborhood(std::size_t count) const {
  const Tool* rigid = rigidTool();
  PALPATE_ASSERT(rigid, "only a rigid tool can hold nodes");
  Neighborhood near;
  for (const std::int32_t node : nearestNodes(model_.mesh, rigid->nodes, count)) {
    const std::vector<std::int32_t> of_node = unknowns_.atNode(pressures_, node);
    near.unknowns.insert(near.unknowns.end(), of_node.begin(), of_node.end());
    near.batches.insert(near.batches.end(), batches_.of_node[node].begin(),
                        batches_.of_node[node].end());
  }
  sortUnique(near.unknowns);
  sortUnique(near.batches);
  near.entries = entriesAmong(near.unknowns, pattern_);
  return near;
}

}  // namespace palpate
