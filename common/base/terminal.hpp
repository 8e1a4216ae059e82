#pragma once

#include <cstddef>
#include <string>

namespace palpate {

struct TerminalSize {
  std::size_t rows = 24, columns = 80;
};

/// Returns the current size of the terminal behind a file descriptor, since windows are resized; a
/// default size if it is no terminal.
TerminalSize sizeOf(int terminal);

/// Cuts a page of text to the size of a terminal, so that it does not scroll. Lines are cut, and
/// the last row gives the number of lines left out.
std::string fitted(const std::string& text, TerminalSize size);

/// Breaks text at blanks into lines of at most `columns` columns and indents continuation lines. A
/// wider word stays whole.
std::string wrapped(const std::string& text, std::size_t columns, std::size_t indent);

}  // namespace palpate
