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

}  // namespace palpate
