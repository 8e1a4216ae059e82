#pragma once

#include <Eigen/Core>
#include <string>

namespace palpate {

/// The shortest decimal that is read back as the same double, always a TOML float.
std::string decimalToml(double value);
std::string decimalToml(const Eigen::Vector3d& v);  ///< "[x, y, z]"

/// A TOML string in quotes, control characters escaped.
std::string quotedToml(const std::string& text);

}  // namespace palpate
