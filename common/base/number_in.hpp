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

/// Returns the number between `prefix` and `suffix`, such as 12 in "press_0012.vtu"; nullopt unless
/// `text` consists of these three.
template <class Number>
std::optional<Number> numberBetween(std::string_view prefix, std::string_view text,
                                    std::string_view suffix) {
  if (text.size() < prefix.size() + suffix.size() || !text.starts_with(prefix) ||
      !text.ends_with(suffix))
    return std::nullopt;
  text.remove_prefix(prefix.size());
  text.remove_suffix(suffix.size());
  return numberIn<Number>(text);
}

}  // namespace palpate
