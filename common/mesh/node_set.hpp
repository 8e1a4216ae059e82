#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace palpate {

/// Node numbers, sorted and unique.
using NodeSet = std::vector<std::int32_t>;

/// Returns whether the set contains a node.
inline bool contains(const NodeSet& nodes, std::int32_t node) {
  return std::ranges::binary_search(nodes, node);
}

/// Sorts the values and removes duplicates.
template <class Value>
void sortUnique(std::vector<Value>& values) {
  std::ranges::sort(values);
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// Factor by which squared radii are enlarged before a test, so that a node exactly on a sphere
/// counts as inside despite round-off in its coordinates.
inline constexpr double on_the_sphere = 1 + 1e-12;

}  // namespace palpate
