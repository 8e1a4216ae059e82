#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <type_traits>

#include "common/space/lattice.hpp"

namespace palpate {

/// Identifies a transition of a build and its result: configuration space, target point and parent
/// point. The origin is its own parent, since it is solved from the rest state. A key means the
/// same in every process and can be read without a plan.
struct ResultKey {
  std::uint32_t space = 0;
  LatticePoint target = {}, parent = {};
  auto operator<=>(const ResultKey&) const = default;
};
std::string textOf(const ResultKey& key);  ///< text for messages

/// Hash for unordered containers. It is not noexcept, so that the standard library caches hashes
/// beside the keys. That costs no memory here and halves the work of growing.
struct HashOfResultKey {
  std::size_t operator()(const ResultKey& key) const {
    static_assert(std::has_unique_object_representations_v<ResultKey>);
    return std::hash<std::string_view>()({reinterpret_cast<const char*>(&key), sizeof(key)});
  }
};

}  // namespace palpate
