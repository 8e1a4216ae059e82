#include "common/base/printable.hpp"

#include <algorithm>

namespace palpate {

std::string printable(std::string_view text, std::size_t most) {
  std::string plain(text.substr(0, most));
  std::ranges::replace_if(
      plain, [](unsigned char c) { return c < 0x20 || c > 0x7e; }, '?');
  return plain;
}

}  // namespace palpate
