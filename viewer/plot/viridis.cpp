#include "viewer/plot/viridis.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// At equal distances.
constexpr std::array<std::array<int, 3>, 11> stops = {{{68, 1, 84},
                                                       {72, 36, 117},
                                                       {65, 68, 135},
                                                       {53, 95, 141},
                                                       {42, 120, 142},
                                                       {33, 145, 140},
                                                       {34, 168, 132},
                                                       {68, 191, 112},
                                                       {122, 209, 81},
                                                       {189, 223, 38},
                                                       {253, 231, 37}}};

}  // namespace

std::array<double, 3> viridis(double place) {
  // Written so that NaN fails the comparison.
  const double at = place > 0 ? std::min(place, 1.0) * (stops.size() - 1) : 0;
  const auto below = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  std::array<double, 3> colour{};
  for (std::size_t i = 0; i < 3; ++i)
    colour[i] = std::lerp(stops[below][i], stops[below + 1][i], at - static_cast<double>(below));
  return colour;
}

}  // namespace palpate
