#include "common/base/text.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <vector>

namespace palpate {
namespace {

/// Returns whether a shell takes the character literally.
bool isPlain(unsigned char c) {
  return std::isalnum(c) != 0 || std::string_view("_./:=,@%+-").find(char(c)) != std::string::npos;
}

/// Returns the edit distance, in which a swap of adjacent letters counts as one edit.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i)
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      d[i][j] =
          std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

}  // namespace

std::string printable(std::string_view text, std::size_t most) {
  std::string plain(text.substr(0, most));
  std::ranges::replace_if(
      plain, [](unsigned char c) { return c < 0x20 || c > 0x7e; }, '?');
  return plain;
}

std::string shellWord(std::string_view file) {
  std::string name = (file.starts_with('-') ? "./" : "") + std::string(file);
  if (!name.empty() && std::ranges::all_of(name, isPlain)) return name;
  return shellQuoted(name);
}

std::string shellQuoted(std::string_view word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string replacedAll(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

std::string_view nearestWord(std::string_view word, std::span<const std::string_view> words) {
  constexpr std::size_t longest_word = 64;
  // Skip very long words: they are not misspellings, and the table of distance() would be large.
  if (word.size() > longest_word) return {};
  std::string_view nearest;
  std::size_t limit = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string_view candidate : words)
    if (const std::size_t d = distance(word, candidate); d < limit) {
      nearest = candidate;
      limit = d;
    }
  return nearest;
}

std::string listed(std::span<const std::string_view> words, std::string_view last) {
  if (words.size() < 2) return words.empty() ? "" : std::string(words.front());
  return fmt::format("{} {} {}", fmt::join(words.first(words.size() - 1), ", "), last,
                     words.back());
}

}  // namespace palpate
