#pragma once

#include <cstddef>
#include <string>

namespace palpate {

struct TerminalSize {
  std::size_t rows = 24, columns = 80;
};

/// Of the terminal behind a file descriptor, as of now: windows are resized. A usual one where
/// there is none.
TerminalSize sizeOf(int terminal);

/// As much of a page of text as a terminal shows without scrolling: lines are cut, and the last row
/// says how many are left out.
std::string fitted(const std::string& text, TerminalSize size);

/// Lines of at most so many columns, broken at blanks; what is broken off is indented. A word that
/// is wider stays whole.
std::string wrapped(const std::string& text, std::size_t columns, std::size_t indent);

}  // namespace palpate
