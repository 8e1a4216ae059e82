#pragma once

#include <span>
#include <string>
#include <string_view>

namespace palpate {

/// The one of `words` that `word` is probably a misspelling of: the fewest inserted, deleted,
/// replaced or swapped letters, at most a third of its length (and always one). Empty when none is
/// that close.
std::string_view nearestWord(std::string_view word, std::span<const std::string_view> words);

/// `words` as text for messages: "a, b or c"; `last` stands before the last one.
std::string listed(std::span<const std::string_view> words, std::string_view last = "or");

}  // namespace palpate
