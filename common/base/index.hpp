#pragma once

#include <concepts>
#include <cstddef>

namespace palpate {

/// Converts a number of a node, point, cell, ... to an index of a standard container:
/// `nodes[at(number)]`. Numbers are signed, so that -1 can mean "none"; here they must not be
/// negative. Real time.
template <std::signed_integral Number>
constexpr std::size_t at(Number number) noexcept {
  return static_cast<std::size_t>(number);
}

}  // namespace palpate
