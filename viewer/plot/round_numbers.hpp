#pragma once

#include <cmath>
#include <initializer_list>

namespace palpate {

/// Returns the smallest number that is at least `value` (up to rounding) and is 1, 2 or 5 times a
/// power of ten. Scales and grids use such numbers for their ends and steps. value: positive and
/// finite.
inline double roundUp(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (value <= factor * power * (1 + 1e-9)) return factor * power;
  return 10 * power;
}

}  // namespace palpate
