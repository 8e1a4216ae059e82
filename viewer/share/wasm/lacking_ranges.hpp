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
#include <memory>
#include <utility>

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

template <class Range, class Predicate>
constexpr bool all_of(Range&& range, Predicate predicate) {
  return std::all_of(std::begin(range), std::end(range),
                     [&](auto&& value) { return std::invoke(predicate, value); });
}
template <class Range, class Predicate>
constexpr bool any_of(Range&& range, Predicate predicate) {
  return std::any_of(std::begin(range), std::end(range),
                     [&](auto&& value) { return std::invoke(predicate, value); });
}
template <class Range, class Predicate>
constexpr bool none_of(Range&& range, Predicate predicate) {
  return !any_of(range, predicate);
}
template <class Range, class Visit>
constexpr void for_each(Range&& range, Visit visit) {
  std::for_each(std::begin(range), std::end(range), std::ref(visit));
}
template <class Range, class Out>
constexpr auto copy(Range&& range, Out out) {
  return std::copy(std::begin(range), std::end(range), out);
}
template <class Range, class Value>
constexpr void fill(Range&& range, const Value& value) {
  std::fill(std::begin(range), std::end(range), value);
}
template <class Range, class Less = std::less<>, class Projection = std::identity>
constexpr bool is_sorted(Range&& range, Less less = {}, Projection projection = {}) {
  return std::is_sorted(std::begin(range), std::end(range), byProjection(less, projection));
}
template <class Range, class Less = std::less<>, class Projection = std::identity>
constexpr void sort(Range&& range, Less less = {}, Projection projection = {}) {
  std::sort(std::begin(range), std::end(range), byProjection(less, projection));
}
template <class Range, class Less = std::less<>, class Projection = std::identity>
void stable_sort(Range&& range, Less less = {}, Projection projection = {}) {
  std::stable_sort(std::begin(range), std::end(range), byProjection(less, projection));
}
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
template <class Range, class Value, class Less = std::less<>>
constexpr bool binary_search(Range&& range, const Value& value, Less less = {}) {
  return std::binary_search(std::begin(range), std::end(range), value, less);
}
template <class Range, class Less = std::less<>>
constexpr auto max_element(Range&& range, Less less = {}) {
  return std::max_element(std::begin(range), std::end(range), less);
}
template <class Range, class Less = std::less<>, class Projection = std::identity>
constexpr auto min_element(Range&& range, Less less = {}, Projection projection = {}) {
  return std::min_element(std::begin(range), std::end(range), byProjection(less, projection));
}
template <class Range, class Predicate>
constexpr auto adjacent_find(Range&& range, Predicate predicate) {
  return std::adjacent_find(std::begin(range), std::end(range), predicate);
}

}  // namespace ranges
}  // namespace std

#endif
