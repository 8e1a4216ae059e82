#include "common/scene/key_line.hpp"

#include <algorithm>
#include <string>

namespace palpate {
namespace {

std::string_view trimmed(std::string_view text, std::string_view blanks = " \t\r") {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// What a sentence speaks of.
struct NamedKey {
  std::string_view table, key;  ///< no table: above the first; no key: the table itself
  std::string_view value = {};  ///< in quotes in the sentence: tells which of several tables it is
};

NamedKey namedIn(std::string_view sentence) {
  if (sentence.starts_with("["))
    return {trimmed(sentence.substr(0, sentence.find_first_of("] ")), "[]"), ""};
  if (sentence.starts_with("mesh =") || sentence.starts_with("the mesh is ") ||
      sentence.starts_with("the mesh consists "))
    return {"", "mesh"};
  if (sentence.starts_with("a finger of radius")) return {"active", "radius"};
  const std::size_t quote = sentence.find('"');
  if (sentence.starts_with("active \"")) {
    const std::string_view rest = sentence.substr(quote + 1);
    return {"active", "name", rest.substr(0, rest.find('"'))};
  }
  const std::string_view path = sentence.substr(0, sentence.find_first_of(": "));
  const std::size_t dot = path.find('.');
  if (dot == std::string_view::npos) return {};
  const std::string_view key = path.substr(dot + 1);
  const std::string_view quoted = quote == std::string_view::npos ? "" : sentence.substr(quote + 1);
  return {path.substr(0, dot), key.substr(0, key.find('.')), quoted.substr(0, quoted.find('"'))};
}

}  // namespace

std::size_t lineOfKey(std::string_view scene_text, std::string_view sentence) {
  const NamedKey wanted = namedIn(sentence);
  if (wanted.table.empty() && wanted.key.empty()) return 0;
  std::string_view table;
  std::size_t number = 0, of_table = 0, of_key = 0;
  bool several = false;
  for (std::size_t begin = 0; begin < scene_text.size();) {
    const std::size_t end = std::min(scene_text.find('\n', begin), scene_text.size());
    const std::string_view line = trimmed(scene_text.substr(begin, end - begin));
    begin = end + 1;
    ++number;
    if (line.starts_with("[")) {
      table = trimmed(line.substr(0, line.find(']')), "[] \t");
      if (table == wanted.table && of_table == 0) of_table = number;
      continue;
    }
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos || table != wanted.table || wanted.key.empty()) continue;
    // A key may have its own dots: below.fraction.
    const std::string_view key = trimmed(line.substr(0, equals));
    if (key.substr(0, key.find('.')) != wanted.key) continue;
    const auto holds = [&](char quote) {
      return line.find(quote + std::string(wanted.value) + quote) != std::string_view::npos;
    };
    if (!wanted.value.empty() && (holds('"') || holds('\''))) return number;
    several = of_key != 0;
    if (of_key == 0) of_key = number;
  }
  // Of several tables with that key nobody knows which one is meant.
  if (several) return wanted.table == "active" && wanted.key == "name" ? of_table : 0;
  return of_key != 0 ? of_key : of_table;
}

}  // namespace palpate
