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

/// Converts a length to metres. Divides if 1 / metres_per_unit is whole, so that 20 mm become
/// exactly the double 0.02, and 2.5 mm likewise. Lengths that are no doubles, such as 134.4 mm, may
/// differ in the last bit.
inline double toMetres(double length, double metres_per_unit) {
  const double units_per_metre = std::round(1 / metres_per_unit);
  return units_per_metre * metres_per_unit == 1 ? length / units_per_metre
                                                : length * metres_per_unit;
}

}  // namespace palpate
