#include "common/scene/toml_section.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "common/base/text.hpp"
#include "common/base/units.hpp"

namespace palpate {
namespace {

/// Returns a hint to append to an error about an unknown word: "; did you mean \"spacing\"?", or a
/// list of the valid words if none is similar.
std::string hint(std::string_view word, TomlSection::Words words) {
  const std::string_view nearest = nearestWord(word, words);
  if (nearest.empty()) return fmt::format("; write {}", listed(words));
  return fmt::format("; did you mean \"{}\"?", nearest);
}

/// Returns the line of a node in the scene file. It is 0 for a table that is not written itself and
/// exists only because of its inner tables.
int sceneLine(const toml::source_region& source) { return static_cast<int>(source.begin.line); }

std::string_view kindOf(const toml::node& node) {
  if (node.is_table()) return "a table";
  if (node.is_array()) return "a list";
  if (node.is_string()) return "text";
  if (node.is_number()) return "a number";
  return node.is_boolean() ? "true or false" : "a date or time";
}

}  // namespace

TomlSection::TomlSection(const TomlContext& context, const toml::table& table, std::string name,
                         Words keys)
    : context_(context), table_(table), name_(std::move(name)) {
  for (const auto& [key, node] : table_)
    if (std::ranges::find(keys, key.str()) == keys.end())
      throw badInput("{}:{}: unknown key \"{}\"{}", context_.source, sceneLine(node.source()),
                     pathOf(key.str()), hint(key.str(), keys));
}

const toml::node& TomlSection::require(std::string_view key, std::string_view meaning) const {
  if (const toml::node* node = find(key)) return *node;
  throw badInput("{}: \"{}\" is missing: {}", place(table_), pathOf(key), meaning);
}

KeyLines TomlSection::lines() const {
  KeyLines lines = {sceneLine(table_.source())};
  for (const auto& [key, node] : table_)
    lines.keys.emplace_back(key.str(), sceneLine(key.source()));
  return lines;
}

double TomlSection::number(std::string_view key, const toml::node& node) const {
  const auto value = node.is_number() ? node.value<double>() : std::nullopt;
  if (!value) throw wrong(key, "a number is expected, not {}", kindOf(node));
  if (!std::isfinite(*value)) throw wrong(key, "must be finite");
  return *value;
}

double TomlSection::positive(std::string_view key, const toml::node& node) const {
  const double value = number(key, node);
  if (!(value > 0)) throw wrong(key, "must be greater than 0, not {}", value);
  return value;
}

double TomlSection::metres(double length) const {
  return toMetres(length, context_.metres_per_unit);
}

double TomlSection::positiveLength(std::string_view key, const toml::node& node) const {
  const double length = metres(positive(key, node));
  constexpr double shortest = 1e-12;
  if (!(length >= shortest))
    throw wrong(key, "is {:g} m, and must be at least {:g}: is the unit right?", length, shortest);
  return length;
}

Eigen::Vector3d TomlSection::vector(std::string_view key, const toml::node& node) const {
  const toml::array* array = node.as_array();
  if (array == nullptr || array->size() != 3)
    throw wrong(key, "three numbers [x, y, z] are expected");
  return {number(key, *array->get(0)), number(key, *array->get(1)), number(key, *array->get(2))};
}

Eigen::Vector3d TomlSection::point(std::string_view key, const toml::node& node) const {
  return vector(key, node).unaryExpr([this](double length) { return metres(length); });
}

std::vector<double> TomlSection::numbers(std::string_view key, const toml::node& node) const {
  const toml::array* array = node.as_array();
  if (array == nullptr) throw wrong(key, "a list of numbers is expected, not {}", kindOf(node));
  return mapped(*array, [&](const toml::node& element) { return number(key, element); });
}

std::int32_t TomlSection::nodeNumber(std::string_view key, const toml::node& node) const {
  const auto value = node.is_integer() ? node.value<std::int64_t>() : std::nullopt;
  if (!value) throw wrong(key, "a node number (an integer) is expected, not {}", kindOf(node));
  if (*value < 0 || *value > std::numeric_limits<std::int32_t>::max())
    throw wrong(key, "node number {} is invalid; nodes are numbered from 0", *value);
  return static_cast<std::int32_t>(*value);
}

std::int32_t TomlSection::integer(std::string_view key, std::int32_t otherwise, std::int32_t lowest,
                                  std::int32_t highest) const {
  const toml::node* node = find(key);
  if (node == nullptr) return otherwise;
  const auto value = node->is_integer() ? node->value<std::int64_t>() : std::nullopt;
  if (!value) throw wrong(key, "an integer is expected, not {}", kindOf(*node));
  if (*value < lowest || *value > highest)
    throw wrong(key, "must be between {} and {}, not {}", lowest, highest, *value);
  return static_cast<std::int32_t>(*value);
}

std::string TomlSection::text(std::string_view key, const toml::node& node) const {
  const auto value = node.is_string() ? node.value<std::string>() : std::nullopt;
  if (!value) throw wrong(key, "text in quotes is expected, not {}", kindOf(node));
  if (value->empty()) throw wrong(key, "must not be empty");
  return *value;
}

bool TomlSection::flag(std::string_view key, const toml::node& node) const {
  if (!node.is_boolean()) throw wrong(key, "true or false is expected, not {}", kindOf(node));
  return *node.value<bool>();
}

std::size_t TomlSection::choice(std::string_view key, const toml::node& node, Words words) const {
  PALPATE_ASSERT(!words.empty(), "a key with a choice must have words to choose from");
  const std::string value = text(key, node);
  const auto found = std::ranges::find(words, value);
  if (found == words.end()) throw wrong(key, "there is no \"{}\"{}", value, hint(value, words));
  return static_cast<std::size_t>(found - words.begin());
}

std::vector<const toml::node*> TomlSection::oneOrMany(std::string_view key) const {
  std::vector<const toml::node*> nodes;
  const toml::node* node = find(key);
  if (node == nullptr) return nodes;
  const toml::array* array = node->as_array();
  if (array == nullptr) return {node};
  if (array->empty()) throw wrong(key, "the list is empty");
  for (const toml::node& element : *array) nodes.push_back(&element);
  return nodes;
}

const toml::array& TomlSection::tables(std::string_view key, std::string_view each) const {
  const std::string meaning = fmt::format("write one [[{}]] table for each {}", key, each);
  const toml::array* array = require(key, meaning).as_array();
  if (array == nullptr || array->empty())
    throw wrong(key, "write [[{}]], in double brackets, once for each {}", key, each);
  return *array;
}

TomlSection TomlSection::inner(std::string_view key, const toml::node& node, Words keys) const {
  const toml::table* table = node.as_table();
  if (table == nullptr) throw wrong(key, "a table is expected, not {}", kindOf(node));
  return {context_, *table, pathOf(key), keys};
}

Error TomlSection::objection(std::string_view key, const std::string& what) const {
  const toml::node* node = find(key);
  return badInput("{}: {}: {}", place(node ? *node : static_cast<const toml::node&>(table_)),
                  pathOf(key), what);
}

std::string TomlSection::pathOf(std::string_view key) const {
  return name_.empty() ? std::string(key) : fmt::format("{}.{}", name_, key);
}

std::string TomlSection::place(const toml::node& node) const {
  const int line = sceneLine(node.source());
  return line > 0 ? fmt::format("{}:{}", context_.source, line) : context_.source;
}

}  // namespace palpate
