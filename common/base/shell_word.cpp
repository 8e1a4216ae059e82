#include "common/base/shell_word.hpp"

#include <algorithm>
#include <cctype>

namespace palpate {
namespace {

/// That no shell reads as anything else.
bool isPlain(unsigned char c) {
  return std::isalnum(c) != 0 || std::string_view("_./:=,@%+-").find(char(c)) != std::string::npos;
}

}  // namespace

std::string shellWord(std::string_view file) {
  std::string name = (file.starts_with('-') ? "./" : "") + std::string(file);
  if (!name.empty() && std::ranges::all_of(name, isPlain)) return name;
  std::string quoted = "'";
  for (const char c : name) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace palpate
