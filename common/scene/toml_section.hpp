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

/// File name of a scene, for errors, and unit of its lengths.
struct TomlContext {
  std::string source;
  double metres_per_unit = 1;
};

/// One table of a scene file. All functions throw Error (bad input) with file, line and key if a
/// key or value is not as expected. Keeps references to the context and the table, which must
/// outlive this object.
class TomlSection {
 public:
  using Words = std::span<const std::string_view>;

  /// Refuses keys that are not among `keys`. `name` precedes keys in errors, as in "fixed.below".
  TomlSection(const TomlContext& context, const toml::table& table, std::string name, Words keys);

  /// Returns the value of `key`, or null.
  const toml::node* find(std::string_view key) const { return table_.get(key); }
  bool has(std::string_view key) const { return find(key) != nullptr; }
  /// Returns the value of a required key; `meaning` describes it in the error if it is missing.
  const toml::node& require(std::string_view key, std::string_view meaning) const;

  /// Returns the line numbers of the table and of its keys.
  KeyLines lines() const;

  /// Makes an error about the value of `key`, or about the table if the key is absent.
  template <class... Args>
  Error wrong(std::string_view key, fmt::format_string<Args...> format, Args&&... args) const {
    return objection(key, fmt::format(format, std::forward<Args>(args)...));
  }

  // Readers of a value. Errors name `key`.
  double number(std::string_view key, const toml::node& node) const;    ///< finite
  double positive(std::string_view key, const toml::node& node) const;  ///< > 0
  /// A length > 0, converted to metres. At least 1e-12 m, so that quotients by it are finite.
  double positiveLength(std::string_view key, const toml::node& node) const;
  /// Three numbers, without conversion of units.
  Eigen::Vector3d vector(std::string_view key, const toml::node& node) const;
  /// Three lengths, converted to metres.
  Eigen::Vector3d point(std::string_view key, const toml::node& node) const;
  std::vector<double> numbers(std::string_view key, const toml::node& node) const;
  /// An integer >= 0 that fits in int32.
  std::int32_t nodeNumber(std::string_view key, const toml::node& node) const;
  std::string text(std::string_view key, const toml::node& node) const;  ///< not empty
  bool flag(std::string_view key, const toml::node& node) const;

  /// Pointer to one of the readers above, for a value of type Value.
  template <class Value>
  using Reading = Value (TomlSection::*)(std::string_view, const toml::node&) const;
  /// Reads a required key with `reading`; `meaning` describes it in the error if it is missing.
  template <class Value>
  Value require(std::string_view key, std::string_view meaning, Reading<Value> reading) const {
    return (this->*reading)(key, require(key, meaning));
  }
  /// Reads an optional key.
  template <class Value>
  std::optional<Value> optional(std::string_view key, Reading<Value> reading) const {
    const toml::node* node = find(key);
    return node ? std::optional((this->*reading)(key, *node)) : std::nullopt;
  }
  /// Reads an optional key into `value`, which holds the default.
  template <class Value>
  void read(std::string_view key, Value& value, Reading<Value> reading) const {
    if (const std::optional<Value> given = optional(key, reading)) value = *given;
  }

  /// Returns the index in `words` of the value of `key`.
  std::size_t choice(std::string_view key, const toml::node& node, Words words) const;
  /// Returns the enumerator whose word (words_of in formulation.hpp) is the value of `key`, or
  /// `otherwise` if the key is absent.
  template <class Choice>
  Choice choice(std::string_view key, Choice otherwise) const {
    const toml::node* node = find(key);
    return node ? static_cast<Choice>(choice(key, *node, words_of<Choice>)) : otherwise;
  }
  /// Returns the integer value of `key`, which must be in lowest..highest, or `otherwise` if the
  /// key is absent.
  std::int32_t integer(std::string_view key, std::int32_t otherwise, std::int32_t lowest,
                       std::int32_t highest) const;
  /// Converts a length from the unit of the file to metres.
  double metres(double length) const;

  /// Returns `key` as a list: empty if absent, the elements of an array, or the single value.
  std::vector<const toml::node*> oneOrMany(std::string_view key) const;
  /// Returns the tables [[key]], of which there must be at least one. For errors, `each` is the
  /// noun for the thing that one table describes.
  const toml::array& tables(std::string_view key, std::string_view each) const;
  /// Returns the table that `key` holds, which may contain only these keys.
  TomlSection inner(std::string_view key, const toml::node& node, Words keys) const;
  TomlSection inner(std::string_view key, const toml::node& node,
                    std::initializer_list<std::string_view> keys) const {
    return inner(key, node, Words(keys.begin(), keys.size()));
  }
  /// Returns the table that `key` holds, or nullopt if the key is absent.
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
