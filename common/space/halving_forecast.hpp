#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace palpate {

/// Estimates how many cells are halved, this one included, until the error of each is allowed. A
/// cell is halved at most `levels` times. Each halving leaves an eighth of the error, and four of
/// the eight parts are halved again. `ratio` is the likely error divided by the allowed error,
/// infinite if answers end in the cell. Only estimates of cost and time use it; no build depends on
/// it.
inline double cellsHalved(double ratio, std::int32_t levels) {
  constexpr double error_by_halving = 8;
  if (ratio <= 1 || levels <= 0) return 0;
  const double asked = std::ceil(std::log(ratio) / std::log(error_by_halving));
  return (std::pow(4, std::min(asked, double(levels))) - 1) / 3;
}

}  // namespace palpate
