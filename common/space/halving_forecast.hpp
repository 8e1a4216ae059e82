#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace palpate {

/// Estimates how often refinement will split a given cell and its parts (each into eight) until all
/// parts meet the allowed error. The split of the cell itself is included. `ratio` is the likely
/// error of the cell divided by the allowed error. It is infinite for a cell with a corner that
/// could not be solved. `levels` is the largest number of successive splits. The estimate assumes
/// that each split reduces the error to an eighth, and that four of the eight parts are split
/// again. Only forecasts of cost and time use the estimate; it does not influence builds.
inline double cellsHalved(double ratio, std::int32_t levels) {
  constexpr double error_by_halving = 8;
  if (ratio <= 1 || levels <= 0) return 0;
  const double asked = std::ceil(std::log(ratio) / std::log(error_by_halving));
  return (std::pow(4, std::min(asked, double(levels))) - 1) / 3;
}

}  // namespace palpate
