#pragma once

#include <array>
#include <cmath>
#include <string_view>

namespace palpate {

/// A unit that lengths are written in.
struct LengthUnit {
  std::string_view word;  ///< in scenes: length_unit = "mm"
  std::string_view name;  ///< in sentences: "millimetres"
  double metres = 1;
};

/// Every unit that a scene may name, largest first.
inline constexpr std::array<LengthUnit, 3> length_units = {
    {{"m", "metres", 1}, {"cm", "centimetres", 0.01}, {"mm", "millimetres", 0.001}}};

/// A length in metres. Divides where 1 / metres_per_unit is whole, so that 20 mm are exactly the
/// double 0.02 (2.5 mm too; of lengths like 134.4 mm, which are no doubles themselves, the last bit
/// may differ).
inline double toMetres(double length, double metres_per_unit) {
  const double units_per_metre = std::round(1 / metres_per_unit);
  return units_per_metre * metres_per_unit == 1 ? length / units_per_metre
                                                : length * metres_per_unit;
}

}  // namespace palpate
