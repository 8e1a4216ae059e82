#pragma once

#include <array>
#include <cmath>
#include <string_view>

namespace palpate {

/// A unit of length.
struct LengthUnit {
  std::string_view word;  ///< in scenes: length_unit = "mm"
  std::string_view name;  ///< in sentences: "millimetres"
  double metres = 1;
};

/// Every unit that a scene may use, largest first.
inline constexpr std::array<LengthUnit, 3> length_units = {
    {{"m", "metres", 1}, {"cm", "centimetres", 0.01}, {"mm", "millimetres", 0.001}}};

/// Converts a length to metres. If 1 / metres_per_unit is an integer, divides by it, so that 20 mm
/// becomes the same double as 0.02. Lengths that a double cannot represent exactly, such as 134.4
/// mm, may still differ from the literal in metres by one rounding.
inline double toMetres(double length, double metres_per_unit) {
  const double units_per_metre = std::round(1 / metres_per_unit);
  return units_per_metre * metres_per_unit == 1 ? length / units_per_metre
                                                : length * metres_per_unit;
}

}  // namespace palpate
