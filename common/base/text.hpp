#pragma once

#include <span>
#include <string>
#include <string_view>

// Text for messages and shells, and corrections of misspelled words.

namespace palpate {

/// Value of `most` in printable() for a whole sentence from a peer or an external program, such as
/// the reason for a refusal. For names the default is used.
inline constexpr std::size_t longest_reason = 500;

/// Makes text from a peer safe to display. Cuts it to `most` bytes and replaces everything but
/// printable ASCII by ?, so that it cannot move the cursor or start a new line.
std::string printable(std::string_view text, std::size_t most = 64);

/// Returns a file name as one word for a POSIX shell, for commands that users copy and paste. The
/// word is quoted if necessary and cannot be mistaken for an option.
std::string shellWord(std::string_view file);

/// Quotes a word for the shell.
std::string shellQuoted(std::string_view word);

/// Replaces each `from` in `text` by `to`. `from` must not be empty.
std::string replacedAll(std::string text, std::string_view from, std::string_view to);

/// Returns the entry of `words` that `word` is probably a misspelling of. This is the entry with
/// the fewest insertions, deletions, replacements and swaps of adjacent letters. One edit is always
/// allowed; more are allowed up to a third of the letters of `word`. Returns an empty string if no
/// entry is that close.
std::string_view nearestWord(std::string_view word, std::span<const std::string_view> words);

/// Joins words for a message, such as "a, b or c". `last` is the word between the last two.
std::string listed(std::span<const std::string_view> words, std::string_view last = "or");

}  // namespace palpate
