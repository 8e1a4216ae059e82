#pragma once

#include <charconv>
#include <optional>
#include <string_view>

namespace palpate {

/// Parses `text` with std::from_chars. Returns nullopt unless the whole text is one number that a
/// Number can represent.
template <class Number>
std::optional<Number> numberIn(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace palpate
