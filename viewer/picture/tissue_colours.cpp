#include "viewer/picture/tissue_colours.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr Rgb dark_tissue = {120, 44, 36}, light_tissue = {144, 62, 50};
/// Colour of tissue that is not touchable, which is blended toward this pale pink.
constexpr Rgb pale_tissue = {196, 158, 148};
constexpr double paleness = 0.62;
constexpr double blotch_frequency = 8;  // blotches per radius of the body
constexpr double covered_from = 0.2;
/// Colours at even distances on the scale. It begins with plum instead of red, because a blend from
/// red to the blue of viridis passes through grey.
constexpr std::array<Rgb, 9> hues = {{{124, 62, 118},
                                      {104, 79, 146},
                                      {70, 102, 158},
                                      {42, 127, 147},
                                      {34, 150, 138},
                                      {54, 174, 116},
                                      {111, 200, 88},
                                      {183, 222, 45},
                                      {253, 231, 37}}};
/// The scale PRGn of ColorBrewer (Brewer and Harrower), reversed.
constexpr std::array<Rgb, 9> pressure_hues = {{{27, 120, 55},
                                               {90, 174, 97},
                                               {166, 219, 160},
                                               {217, 240, 211},
                                               {247, 247, 247},
                                               {231, 212, 232},
                                               {194, 165, 207},
                                               {153, 112, 171},
                                               {118, 42, 131}}};

Rgb between(const Rgb& from, const Rgb& to, double share) {
  return {std::lerp(from[0], to[0], share), std::lerp(from[1], to[1], share),
          std::lerp(from[2], to[2], share)};
}

/// Interpolates between colours at even distances. place: clamped to 0 to 1.
template <std::size_t count>
Rgb among(const std::array<Rgb, count>& colours, double place) {
  const double at = std::clamp(place, 0.0, 1.0) * (count - 1);
  const std::size_t below = std::min<std::size_t>(static_cast<std::size_t>(at), count - 2);
  return between(colours[below], colours[below + 1], at - static_cast<double>(below));
}

}  // namespace

const char* word(SurfaceColour colour) {
  switch (colour) {
    case SurfaceColour::tissue: return "tissue";
    case SurfaceColour::displacement: return "displacement";
    case SurfaceColour::error: return "error bound";
    case SurfaceColour::pressure: break;
  }
  return "pressure";
}

Rgb tissueColour(double felt, double blotch) {
  return between(between(dark_tissue, light_tissue, blotch), pale_tissue, paleness * (1 - felt));
}

double blotchAt(const Eigen::Vector3d& scaled) {
  const Eigen::Vector3d x = blotch_frequency * scaled;
  return 0.5 + 0.5 * std::sin(3.1 * x.x() + std::sin(2.3 * x.y())) *
                   std::sin(2.9 * x.y() + std::sin(2.7 * x.z())) *
                   std::sin(3.3 * x.z() + std::sin(2.1 * x.x()));
}

double displacementCover(double place) {
  const double share = std::clamp(place / covered_from, 0.0, 1.0);
  return share * share * (3 - 2 * share);
}

Rgb displacementHue(double place) { return among(hues, place); }

Rgb displacementColour(double place, const Rgb& tissue) {
  return between(tissue, displacementHue(place), displacementCover(place));
}

Rgb pressureColour(double place) { return among(pressure_hues, 0.5 + 0.5 * place); }

}  // namespace palpate
