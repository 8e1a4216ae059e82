#pragma once

#include <concepts>
#include <cstddef>

namespace palpate {

/// A number of a node, point, cell, ..., which is signed so that -1 can mean "none", as the index
/// of a standard container: `nodes[at(number)]`. The number is not negative. Real time.
template <std::signed_integral Number>
constexpr std::size_t at(Number number) noexcept {
  return static_cast<std::size_t>(number);
}

}  // namespace palpate
