#include "common/base/units.hpp"

#include <cmath>

namespace palpate {

double toMetres(double length, double metres_per_unit) {
  const double units_per_metre = std::round(1 / metres_per_unit);
  return units_per_metre * metres_per_unit == 1 ? length / units_per_metre
                                                : length * metres_per_unit;
}

}  // namespace palpate
