#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <string>

#include "common/base/index.hpp"

namespace palpate {

/// Returns the shortest decimal that reads back as the same double. It always has a point or an
/// exponent, so that TOML reads it as a float.
inline std::string decimalToml(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}
/// Returns "[x, y, z]".
inline std::string decimalToml(const Eigen::Vector3d& v) {
  return fmt::format("[{}, {}, {}]", decimalToml(v[0]), decimalToml(v[1]), decimalToml(v[2]));
}

/// Returns a quoted TOML string with control characters escaped.
inline std::string quotedToml(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      (out += '\\') += c;
    else if (code < 0x20 || code == 0x7f)
      out += fmt::format("\\u{:04X}", code);
    else
      out += c;
  }
  return out + "\"";
}

}  // namespace palpate
