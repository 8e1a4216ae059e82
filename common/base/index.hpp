#pragma once

#include <concepts>
#include <cstddef>

namespace palpate {

/// Converts the number of a node, point or cell to an index into a standard container, as in
/// `nodes[at(number)]`. Such numbers are signed, so that -1 can mean "none", but `number` must not
/// be negative here. Real time.
template <std::signed_integral Number>
constexpr std::size_t at(Number number) noexcept {
  return static_cast<std::size_t>(number);
}

}  // namespace palpate
