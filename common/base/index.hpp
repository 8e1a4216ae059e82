#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <numeric>
#include <type_traits>
#include <vector>

namespace palpate {

/// Converts the number of a node, point or cell to an index into a standard container, as in
/// `nodes[at(number)]`. These numbers are signed, so that -1 can mean "none", but `number` must not
/// be negative here. Real time.
template <std::signed_integral Number>
constexpr std::size_t at(Number number) noexcept {
  return static_cast<std::size_t>(number);
}

/// Returns the numbers 0, 1, ..., count - 1.
template <std::integral Number = std::int32_t>
std::vector<Number> countUp(std::size_t count) {
  std::vector<Number> numbers(count);
  std::iota(numbers.begin(), numbers.end(), Number{0});
  return numbers;
}

/// Returns function(element) for each element of `range`.
template <class Range, class Function>
auto mapped(const Range& range, Function function) {
  using Value = std::invoke_result_t<Function&, decltype(*std::begin(range))>;
  std::vector<std::decay_t<Value>> values;
  for (const auto& element : range) values.push_back(std::invoke(function, element));
  return values;
}

}  // namespace palpate
