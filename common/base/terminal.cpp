#include "common/base/terminal.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <sstream>
#include <vector>

namespace palpate {

TerminalSize sizeOf(int terminal) {
  struct winsize size {};
  if (ioctl(terminal, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) return {};
  return {size.ws_row, size.ws_col};
}

std::string fitted(const std::string& text, TerminalSize size) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line.substr(0, size.columns));
  // Leave one row free: after the last line feed the cursor is in the row below the text.
  const std::size_t room = std::max<std::size_t>(size.rows, 3) - 1;
  if (lines.size() > room) {
    const std::size_t left_out = lines.size() - (room - 1);
    lines.resize(room - 1);
    lines.push_back(fmt::format("... {} more lines", left_out).substr(0, size.columns));
  }
  return fmt::format("{}\n", fmt::join(lines, "\n"));
}

std::string wrapped(const std::string& text, std::size_t columns, std::size_t indent) {
  std::string out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    while (line.size() > columns) {
      std::size_t blank = line.rfind(' ', columns);
      if (blank == std::string::npos || blank < indent) blank = line.find(' ', columns);
      if (blank == std::string::npos) break;
      out += line.substr(0, blank) + '\n';
      line = std::string(indent, ' ') + line.substr(blank + 1);
    }
    out += line + '\n';
  }
  return out;
}

}  // namespace palpate
