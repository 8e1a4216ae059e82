#pragma once

#include <charconv>
#include <optional>
#include <string_view>

namespace palpate {

/// The number that `text` is, as std::from_chars reads it; nothing when something else stands
/// there, before or behind it too, or it does not fit.
template <class Number>
std::optional<Number> numberIn(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace palpate
