#include "common/scene/toml_text.hpp"

#include <fmt/format.h>

namespace palpate {

std::string decimalToml(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string decimalToml(const Eigen::Vector3d& v) {
  return fmt::format("[{}, {}, {}]", decimalToml(v[0]), decimalToml(v[1]), decimalToml(v[2]));
}

std::string quotedToml(const std::string& text) {
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
