#pragma once

// Parts of C++20 that the fields use and the standard library of Emscripten 3.1.6 (libc++ 13)
// lacks. The build includes this file before the sources of the fields when it compiles them to
// WebAssembly. The functions call the algorithms with iterators. If all sorted keys differ, as ours
// do, the results are the same as with any other library.
#include <version>
#if defined(_LIBCPP_VERSION) && _LIBCPP_VERSION < 15000

#include <algorithm>
#include <array>
#include <compare>
#include <functional>
#include <iterator>

namespace std {

template <class T, size_t n>
constexpr auto operator<=>(const array<T, n>& a, const array<T, n>& b) {
  for (size_t i = 0; i < n; ++i)
    if (const auto order = a[i] <=> b[i]; order != 0) return order;
  return a.size() <=> b.size();
}

namespace ranges {

/// Returns a comparison of two values by their projections.
template <class Less, class Projection>
constexpr auto byProjection(Less less, Projection projection) {
  return [=](const auto& a, const auto& b) {
    return std::invoke(less, std::invoke(projection, a), std::invoke(projection, b));
  };
}

#define PALPATE_LACKING(algorithm)                                      \
  template <class Range, class... More>                                 \
  constexpr auto algorithm(Range&& range, const More&... more) {        \
    return std::algorithm(std::begin(range), std::end(range), more...); \
  }
PALPATE_LACKING(all_of)
PALPATE_LACKING(any_of)
PALPATE_LACKING(none_of)
PALPATE_LACKING(for_each)
PALPATE_LACKING(copy)
PALPATE_LACKING(fill)
PALPATE_LACKING(binary_search)
PALPATE_LACKING(max_element)
PALPATE_LACKING(adjacent_find)
#undef PALPATE_LACKING

/// Algorithms that compare the projections of elements.
#define PALPATE_LACKING(algorithm)                                                             \
  template <class Range, class Less = std::less<>, class Projection = std::identity>           \
  constexpr auto algorithm(Range&& range, Less less = {}, Projection projection = {}) {        \
    return std::algorithm(std::begin(range), std::end(range), byProjection(less, projection)); \
  }
PALPATE_LACKING(is_sorted)
PALPATE_LACKING(sort)
PALPATE_LACKING(stable_sort)
PALPATE_LACKING(min_element)
#undef PALPATE_LACKING

template <class Range, class Middle, class Less = std::less<>, class Projection = std::identity>
constexpr void partial_sort(Range&& range, Middle middle, Less less = {},
                            Projection projection = {}) {
  std::partial_sort(std::begin(range), middle, std::end(range), byProjection(less, projection));
}
template <class Range, class Value, class Less = std::less<>, class Projection = std::identity>
constexpr auto lower_bound(Range&& range, const Value& value, Less less = {},
                           Projection projection = {}) {
  return std::lower_bound(std::begin(range), std::end(range), value,
                          [&](const auto& element, const Value& wanted) {
                            return std::invoke(less, std::invoke(projection, element), wanted);
                          });
}
}  // namespace ranges
}  // namespace std

#endif
