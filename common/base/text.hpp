#pragma once

#include <span>
#include <string>
#include <string_view>

// Text for messages and shells, and corrections of misspelled words.

namespace palpate {

/// Length of a sentence in which a peer gives the reason of a refusal; names are shorter.
inline constexpr std::size_t longest_reason = 500;

/// Makes text from a peer safe to display: at most `most` bytes, with ? for everything but
/// printable ASCII, so that it cannot move the cursor or start a line.
std::string printable(std::string_view text, std::size_t most = 64);

/// Returns a file name as one word of a POSIX shell, for commands to paste: quoted if necessary,
/// and never mistaken for an option.
std::string shellWord(std::string_view file);

/// Returns the one of `words` that `word` probably misspells: the nearest by insertions, deletions,
/// replacements and swaps of letters. At most a third of its letters, but always one, may be wrong.
/// Empty if none is that close.
std::string_view nearestWord(std::string_view word, std::span<const std::string_view> words);

/// Returns `words` as text for messages: "a, b or c", with `last` before the last one.
std::string listed(std::span<const std::string_view> words, std::string_view last = "or");

}  // namespace palpate
