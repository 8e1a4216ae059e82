#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <concepts>
#include <string>
#include <string_view>

// Numbers as text for messages.

namespace palpate {

/// Returns a count with its noun, such as "1 node" or "2 nodes". Give `plural` for irregular nouns,
/// as in "3 tetrahedra".
template <std::integral Count>
std::string counted(Count count, std::string_view noun, std::string_view plural = {}) {
  if (count == 1) return fmt::format("1 {}", noun);
  return plural.empty() ? fmt::format("{} {}s", count, noun) : fmt::format("{} {}", count, plural);
}

/// Returns the components as text, such as "0.0025, 0, -0.017", each with at most `figures`
/// significant digits. Zero never has a sign.
inline std::string vectorText(const Eigen::Vector3d& v, int figures,
                              std::string_view between = ", ") {
  // Adding 0.0 turns -0.0 into 0.0.
  return fmt::format("{1:.{0}g}{4}{2:.{0}g}{4}{3:.{0}g}", figures, v[0] + 0.0, v[1] + 0.0,
                     v[2] + 0.0, between);
}

}  // namespace palpate
