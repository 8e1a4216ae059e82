#pragma once

#include <toml++/toml.h>

#include <Eigen/Core>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"

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
  /// `meaning` says what is missing.
  const toml::node& require(std::string_view key, std::string_view meaning) const;

  /// An error about the value of `key`, or about the table where there is none.
  template <class... Args>
  Error wrong(std::string_view key, fmt::format_string<Args...> format, Args&&... args) const {
    return objection(key, fmt::format(format, std::forward<Args>(args)...));
  }

  /// A finite number.
  double number(std::string_view key, const toml::node& node) const;
  /// The number > 0 of a key that must be there.
  double positive(std::string_view key, std::string_view meaning) const;
  /// A length as it is written, in metres.
  double metres(double length) const;
  /// The length > 0 of a key that must be there, in metres.
  double positiveLength(std::string_view key, std::string_view meaning) const;
  /// Three numbers as they are written.
  Eigen::Vector3d vector(std::string_view key, const toml::node& node) const;
  /// Three lengths, in metres.
  Eigen::Vector3d point(std::string_view key, const toml::node& node) const;
  std::vector<double> numbers(std::string_view key, const toml::node& node) const;
  /// An integer >= 0 that fits.
  std::int32_t nodeNumber(std::string_view key, const toml::node& node) const;
  /// An integer in lowest..highest.
  std::int32_t integer(std::string_view key, const toml::node& node, std::int32_t lowest,
                       std::int32_t highest) const;
  std::string text(std::string_view key, const toml::node& node) const;  ///< not empty
  bool flag(std::string_view key, bool otherwise) const;
  /// The position in `words` of the word that `key` holds.
  std::size_t choice(std::string_view key, const toml::node& node, Words words) const;

  /// `key` as a list: nothing when it is absent, its elements when it is an array, else itself
  /// alone.
  std::vector<const toml::node*> oneOrMany(std::string_view key) const;
  /// The table that `key` holds, in which these keys may stand.
  TomlSection inner(std::string_view key, const toml::node& node, Words keys) const;
  TomlSection inner(std::string_view key, const toml::node& node,
                    std::initializer_list<std::string_view> keys) const {
    return inner(key, node, Words(keys.begin(), keys.size()));
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
