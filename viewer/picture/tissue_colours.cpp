#include "viewer/picture/tissue_colours.hpp"

#include <algorithm>
#include <cmath>

#include "viewer/plot/viridis.hpp"

namespace palpate {
namespace {

constexpr Rgb dark_tissue = {120, 44, 36}, light_tissue = {144, 62, 50};
/// Tissue that is not touchable is blended toward this pale pink.
constexpr Rgb pale_tissue = {196, 158, 148};
constexpr double paleness = 0.62;
constexpr double blotch_frequency = 8;  // blotches per radius of the body
constexpr double covered_from = 0.2;
/// Colours at even distances on the displacement scale, 0xRRGGBB. The scale begins with plum
/// instead of red, because a blend from red to the blue of viridis passes through grey.
constexpr std::array<int, 9> hues = {0x7c3e76, 0x684f92, 0x46669e, 0x2a7f93, 0x22968a,
                                     0x36ae74, 0x6fc858, 0xb7de2d, 0xfde725};
/// The scale PRGn of ColorBrewer (Brewer and Harrower), reversed.
constexpr std::array<int, 9> pressure_hues = {0x1b7837, 0x5aae61, 0xa6dba0, 0xd9f0d3, 0xf7f7f7,
                                              0xe7d4e8, 0xc2a5cf, 0x9970ab, 0x762a83};

Rgb between(const Rgb& from, const Rgb& to, double share) {
  return {std::lerp(from[0], to[0], share), std::lerp(from[1], to[1], share),
          std::lerp(from[2], to[2], share)};
}

}  // namespace

Rgb tissueColour(double felt, double blotch) {
  return between(between(dark_tissue, light_tissue, blotch), pale_tissue, paleness * (1 - felt));
}

double blotchAt(const Eigen::Vector3d& scaled) {
  const Eigen::Vector3d x = blotch_frequency * scaled;
  return 0.5 + 0.5 * std::sin(3.1 * x.x() + std::sin(2.3 * x.y())) *
                   std::sin(2.9 * x.y() + std::sin(2.7 * x.z())) *
                   std::sin(3.3 * x.z() + std::sin(2.1 * x.x()));
}

double smoothStep(double from, double to, double x) {
  const double share = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return share * share * (3 - 2 * share);
}

double displacementCover(double place) { return smoothStep(0, covered_from, place); }

Rgb displacementHue(double place) { return colourAmong(hues, place); }

Rgb displacementColour(double place, const Rgb& tissue) {
  return between(tissue, displacementHue(place), displacementCover(place));
}

Rgb pressureColour(double place) { return colourAmong(pressure_hues, 0.5 + 0.5 * place); }

}  // namespace palpate
