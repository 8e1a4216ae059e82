#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace palpate {

/// Red, green, blue, 0 to 255, as the screen takes them.
using Rgb = std::array<double, 3>;

/// What the colours of the surface show: nothing but tissue; how far it is displaced; how well the
/// force is known where it is touched; the pressure in it.
enum class SurfaceColour : std::uint8_t { tissue, displacement, error, pressure };
inline constexpr int surface_colour_count = 4;
/// Round and round.
inline SurfaceColour following(SurfaceColour colour) {
  return static_cast<SurfaceColour>((static_cast<int>(colour) + 1) % surface_colour_count);
}
/// What a person reads: "tissue", "displacement", "error bound", "pressure".
const char* word(SurfaceColour colour);

/// Wet tissue. felt: 1 where it can be touched, 0 where there is nothing to feel, which is paler
/// (and hatched, SoftLight).
/// blotch: 0 to 1, darker to lighter, as tissue has it from place to place.
Rgb tissueColour(double felt, double blotch = 0.5);
/// The blotch at a place of the body at rest. scaled: the place in radii of the body.
double blotchAt(const Eigen::Vector3d& scaled);

/// How much of the colour of a displacement covers the tissue: 0 at none, all from a fifth of the
/// scale on. place: 0 to 1, the displacement as a share of the scale's end.
double displacementCover(double place);
/// The colour of a displacement, before the tissue is seen through it: from plum, which is next to
/// tissue, to the upper half of viridis.
Rgb displacementHue(double place);
/// Both: what the surface has, and its legend. Grows lighter with the place.
Rgb displacementColour(double place, const Rgb& tissue);

/// The colour of a pressure, of the surface and of its legend: from green, tension, over a light
/// grey at none to purple, compression. The ends are told apart by colour-blind people too, and
/// from tissue, the arrow and an uncertain force. place: -1 to 1, the pressure as a share of the
/// scale's end.
Rgb pressureColour(double place);

}  // namespace palpate
