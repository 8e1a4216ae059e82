#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace palpate {

/// How many cells are halved until the error of one is allowed, itself among them, at most `levels`
/// times: each halving leaves an eighth of the error, and four of the eight parts need it again.
/// `ratio`: of the likely error to what is allowed; infinite where answers end in the cell. For
/// estimates of cost and time alone; no build depends on it.
inline double cellsHalved(double ratio, std::int32_t levels) {
  constexpr double error_by_halving = 8;
  if (ratio <= 1 || levels <= 0) return 0;
  const double asked = std::ceil(std::log(ratio) / std::log(error_by_halving));
  return (std::pow(4, std::min(asked, double(levels))) - 1) / 3;
}

}  // namespace palpate
