#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <type_traits>

#include "common/space/lattice.hpp"

namespace palpate {

/// Identifies a transition of a build and its result: the configuration space, the point that is
/// solved (target) and the point that the solve starts from (parent). The origin is its own parent,
/// because it is solved from the rest state. A key contains coordinates rather than numbers of
/// points, so that it means the same in every process.
struct ResultKey {
  std::uint32_t space = 0;
  LatticePoint target = {}, parent = {};
  auto operator<=>(const ResultKey&) const = default;
};
std::string textOf(const ResultKey& key);  ///< for messages

/// Hash for unordered containers. The call operator is not noexcept, so that the standard library
/// stores the hash with each key. This takes no extra memory here, and halves the time to grow a
/// container.
struct HashOfResultKey {
  std::size_t operator()(const ResultKey& key) const {
    static_assert(std::has_unique_object_representations_v<ResultKey>);
    return std::hash<std::string_view>()({reinterpret_cast<const char*>(&key), sizeof(key)});
  }
};

}  // namespace palpate
