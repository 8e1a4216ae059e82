#include "viewer/plot/viridis.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// Colours at even distances on the scale, 0xRRGGBB.
constexpr std::array<int, 11> stops = {0x440154, 0x482475, 0x414487, 0x355f8d, 0x2a788e, 0x21918c,
                                       0x22a884, 0x44bf70, 0x7ad151, 0xbddf26, 0xfde725};

}  // namespace

std::array<double, 3> colourAmong(std::span<const int> colours, double place) {
  // The comparison is false for NaN.
  const double at = place > 0 ? std::min(place, 1.0) * (colours.size() - 1) : 0;
  const std::size_t below = std::min<std::size_t>(at, colours.size() - 2);
  const auto channel = [&](int shift) {
    return std::lerp(colours[below] >> shift & 0xff, colours[below + 1] >> shift & 0xff,
                     at - below);
  };
  return {channel(16), channel(8), channel(0)};
}

std::array<double, 3> viridis(double place) { return colourAmong(stops, place); }

}  // namespace palpate
