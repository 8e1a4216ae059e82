#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace palpate {

/// Sorted node numbers, each once.
using NodeSet = std::vector<std::int32_t>;

/// Whether a node is in the set.
inline bool contains(const NodeSet& nodes, std::int32_t node) {
  return std::ranges::binary_search(nodes, node);
}

/// Makes a set of a list: sorted, each once.
template <class Value>
void sortUnique(std::vector<Value>& values) {
  std::ranges::sort(values);
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// What a squared radius is multiplied by, so that round-off in the coordinates does not decide
/// whether a node exactly on a sphere is within it.
inline constexpr double on_the_sphere = 1 + 1e-12;

}  // namespace palpate
