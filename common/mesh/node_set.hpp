#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace palpate {

/// Sorted node numbers, each once.
using NodeSet = std::vector<std::int32_t>;

inline bool contains(const NodeSet& nodes, std::int32_t node) {
  return std::binary_search(nodes.begin(), nodes.end(), node);
}

inline void sortUnique(NodeSet& nodes) {
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
}

/// What a squared radius is multiplied by, so that round-off in the coordinates does not decide
/// whether a node exactly on a sphere is within it.
inline constexpr double on_the_sphere = 1 + 1e-12;

}  // namespace palpate
