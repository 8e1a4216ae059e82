#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <type_traits>

#include "common/space/lattice.hpp"

namespace palpate {

/// A transition of a build, and its result: which configuration space, to which point, from which
/// one. The origin is its own parent: it is solved from the rest state. Means the same in every
/// process and needs no plan to be read.
struct ResultKey {
  std::uint32_t space = 0;
  LatticePoint target = {}, parent = {};
  auto operator<=>(const ResultKey&) const = default;
};
std::string textOf(const ResultKey& key);  ///< for people

/// For unordered containers. Not noexcept: the standard library keeps hashes beside the keys then,
/// which costs no memory here and spares half of the work of growing.
struct HashOfResultKey {
  std::size_t operator()(const ResultKey& key) const {
    static_assert(std::has_unique_object_representations_v<ResultKey>);
    return std::hash<std::string_view>()({reinterpret_cast<const char*>(&key), sizeof(key)});
  }
};

}  // namespace palpate
