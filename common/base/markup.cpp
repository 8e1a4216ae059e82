#include "common/base/markup.hpp"

#include <array>

namespace palpate {

std::string escaped(std::string_view text) {
  constexpr std::string_view special = "&<>\"'";
  constexpr std::array<const char*, 5> entities = {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"};
  std::string result;
  for (const char c : text) {
    const std::size_t place = special.find(c);
    place < special.size() ? result += entities[place] : result += c;
  }
  return result;
}

std::string scriptJson(std::string json) {
  for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos;)
    json.replace(at, 1, "\\u003c");
  return json;
}

std::string filledMarkup(std::string_view text,
                         const std::map<std::string, std::string, std::less<>>& by) {
  std::string out;
  for (;;) {
    const std::size_t begin = text.find("{{"), end = text.find("}}", begin);
    out += text.substr(0, begin);
    if (begin == std::string_view::npos) return out;
    out += by.at(std::string(text.substr(begin + 2, end - begin - 2)));
    text.remove_prefix(end + 2);
  }
}

}  // namespace palpate
