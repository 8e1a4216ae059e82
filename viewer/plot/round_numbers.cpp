#include "viewer/plot/round_numbers.hpp"

#include <cmath>
#include <initializer_list>

namespace palpate {

double roundUp(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (value <= factor * power * (1 + 1e-9)) return factor * power;
  return 10 * power;
}

}  // namespace palpate
