#pragma once

#include <cstddef>
#include <string>

namespace palpate {

struct TerminalSize {
  std::size_t rows = 24, columns = 80;
};

/// Returns the size of the terminal behind a file descriptor, or a default size if the descriptor
/// is not a terminal. Call it again for each page, because users resize windows.
TerminalSize sizeOf(int terminal);

/// Cuts a page of text to the size of a terminal, so that the terminal does not scroll. Long lines
/// are cut off. If there are too many lines, the last row gives the number of lines left out.
std::string fitted(const std::string& text, TerminalSize size);

/// Breaks text at blanks into lines of at most `columns` columns and indents continuation lines. A
/// word that is longer than a line is not broken.
std::string wrapped(const std::string& text, std::size_t columns, std::size_t indent);

}  // namespace palpate
