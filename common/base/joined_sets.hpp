#pragma once

#include <algorithm>

#include "common/base/index.hpp"

namespace palpate {

/// Disjoint sets of the numbers 0, 1, ..., size - 1 (union-find with path halving). Each number
/// begins in a set of its own.
class JoinedSets {
 public:
  explicit JoinedSets(std::size_t size) : parent_(countUp(size)) {}

  /// Returns the lowest number in the set that contains n.
  std::int32_t lowest(std::int32_t n) {
    while (parent_[n] != n) n = parent_[n] = parent_[parent_[n]];
    return n;
  }

  void join(std::int32_t a, std::int32_t b) {
    a = lowest(a);
    b = lowest(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::int32_t> parent_;
};

}  // namespace palpate
