#pragma once

#include <span>
#include <string>
#include <string_view>

// Texts as people read, mistype and paste them.

namespace palpate {

/// Of a sentence, as peers say why they refuse something; names have less.
inline constexpr std::size_t longest_reason = 500;

/// What a peer sent, as it may be shown to people: at most so many bytes, with ? in place of all
/// that is not printable ASCII, so that it cannot move a cursor or begin a line of its own.
std::string printable(std::string_view text, std::size_t most = 64);

/// A file's name as one word of a POSIX shell, for commands that people paste: quoted where it
/// needs to be, and none of the options of a program.
std::string shellWord(std::string_view file);

/// The one of `words` that `word` is probably a misspelling of: the fewest inserted, deleted,
/// replaced or swapped letters, at most a third of its length (and always one). Empty when none is
/// that close.
std::string_view nearestWord(std::string_view word, std::span<const std::string_view> words);

/// `words` as text for messages: "a, b or c"; `last` stands before the last one.
std::string listed(std::span<const std::string_view> words, std::string_view last = "or");

}  // namespace palpate
