#pragma once

#include <toml++/toml.h>

#include <Eigen/Core>
#include <initializer_list>
#include <optional>
#include <span>
#include <vector>

#include "common/base/error.hpp"
#include "common/scene/formulation.hpp"
#include "common/scene/key_lines.hpp"

namespace palpate {

/// What every value of a scene file needs to be read: the name of the file for errors and the unit
/// of its lengths.
struct TomlContext {
  std::string source;
  double metres_per_unit = 1;
};

/// One table of a scene file. Everything here throws Error (bad input) that names file, line and
/// key when a key or a value is not what is asked for. Refers to the context and the table, which
/// must outlive it.
class TomlSection {
 public:
  using Words = std::span<const std::string_view>;

  /// Refuses keys that are not among `keys`. `name` is what errors put before a key: "fixed.below".
  TomlSection(const TomlContext& context, const toml::table& table, std::string name, Words keys);

  /// The value of `key`, or null.
  const toml::node* find(std::string_view key) const { return table_.get(key); }
  bool has(std::string_view key) const { return find(key) != nullptr; }
  /// The value of a key that must be there; `meaning` says what is missing.
  const toml::node& require(std::string_view key, std::string_view meaning) const;

  /// Where the table and its keys stand.
  KeyLines lines() const;

  /// An error about the value of `key`, or about the table where there is none.
  template <class... Args>
  Error wrong(std::string_view key, fmt::format_string<Args...> format, Args&&... args) const {
    return objection(key, fmt::format(format, std::forward<Args>(args)...));
  }

  // What a value can be read as. `key` is what errors name.
  double number(std::string_view key, const toml::node& node) const;    ///< finite
  double positive(std::string_view key, const toml::node& node) const;  ///< > 0
  /// In metres, and at least 1e-12 of them, so that quotients by it are finite.
  double positiveLength(std::string_view key, const toml::node& node) const;
  /// Three numbers as they are written.
  Eigen::Vector3d vector(std::string_view key, const toml::node& node) const;
  /// Three lengths, in metres.
  Eigen::Vector3d point(std::string_view key, const toml::node& node) const;
  std::vector<double> numbers(std::string_view key, const toml::node& node) const;
  /// An integer >= 0 that fits.
  std::int32_t nodeNumber(std::string_view key, const toml::node& node) const;
  std::string text(std::string_view key, const toml::node& node) const;  ///< not empty
  bool flag(std::string_view key, const toml::node& node) const;

  /// One of these ways.
  template <class Value>
  using Reading = Value (TomlSection::*)(std::string_view, const toml::node&) const;
  /// A key that must be there, read as `reading` does; `meaning` says what is missing.
  template <class Value>
  Value require(std::string_view key, std::string_view meaning, Reading<Value> reading) const {
    return (this->*reading)(key, require(key, meaning));
  }
  /// A key that may be there.
  template <class Value>
  std::optional<Value> optional(std::string_view key, Reading<Value> reading) const {
    const toml::node* node = find(key);
    return node ? std::optional((this->*reading)(key, *node)) : std::nullopt;
  }
  /// The same, into what holds the default.
  template <class Value>
  void read(std::string_view key, Value& value, Reading<Value> reading) const {
    if (const std::optional<Value> given = optional(key, reading)) value = *given;
  }

  /// The position in `words` of the word that `key` holds.
  std::size_t choice(std::string_view key, const toml::node& node, Words words) const;
  /// The enumerator whose word (formulation.hpp) `key` holds, or `otherwise` without the key.
  template <class Choice>
  Choice choice(std::string_view key, Choice otherwise) const {
    const toml::node* node = find(key);
    return node ? static_cast<Choice>(choice(key, *node, words_of<Choice>)) : otherwise;
  }
  /// An integer in lowest..highest, or `otherwise` without the key.
  std::int32_t integer(std::string_view key, std::int32_t otherwise, std::int32_t lowest,
                       std::int32_t highest) const;
  /// A length as it is written, in metres.
  double metres(double length) const;

  /// `key` as a list: nothing when it is absent, its elements when it is an array, else itself
  /// alone.
  std::vector<const toml::node*> oneOrMany(std::string_view key) const;
  /// The tables of [[key]], which must be there, one for `each` of something.
  const toml::array& tables(std::string_view key, std::string_view each) const;
  /// The table that `key` holds, in which these keys may stand.
  TomlSection inner(std::string_view key, const toml::node& node, Words keys) const;
  TomlSection inner(std::string_view key, const toml::node& node,
                    std::initializer_list<std::string_view> keys) const {
    return inner(key, node, Words(keys.begin(), keys.size()));
  }
  /// The same of a table that may be absent.
  std::optional<TomlSection> inner(std::string_view key,
                                   std::initializer_list<std::string_view> keys) const {
    const toml::node* node = find(key);
    return node ? std::optional(inner(key, *node, keys)) : std::nullopt;
  }

 private:
  Error objection(std::string_view key, const std::string& what) const;
  std::string pathOf(std::string_view key) const;
  std::string place(const toml::node& node) const;

  const TomlContext& context_;
  const toml::table& table_;
  std::string name_;
};

}  // namespace palpate
