#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace palpate {

/// Red, green, blue, 0 to 255, in the screen's colour space.
using Rgb = std::array<double, 3>;

/// Quantity that colours the surface: none (tissue); displacement; relative error bound of the
/// force at a touch; pressure.
enum class SurfaceColour : std::uint8_t { tissue, displacement, error, pressure };
inline constexpr int surface_colour_count = 4;
/// Returns the next colour in a cycle.
inline SurfaceColour following(SurfaceColour colour) {
  return static_cast<SurfaceColour>((static_cast<int>(colour) + 1) % surface_colour_count);
}
/// Returns the name of a colour for people: "tissue", "displacement", "error bound", "pressure".
const char* word(SurfaceColour colour);

/// Returns the colour of wet tissue.
///
/// felt: 1 if touchable; 0 if not, which is paler (and hatched, SoftLight). blotch: 0 to 1, from
/// darker to lighter, for variation over the surface.
Rgb tissueColour(double felt, double blotch = 0.5);
/// Returns the blotch at a place of the body at rest. scaled: the place in radii of the body.
double blotchAt(const Eigen::Vector3d& scaled);

/// Returns the opacity of a displacement colour over the tissue: 0 at none, 1 from a fifth of the
/// scale on. place: 0 to 1, share of the scale.
double displacementCover(double place);
/// Returns the opaque colour of a displacement: from plum, which is close to tissue, to the upper
/// half of viridis.
Rgb displacementHue(double place);
/// Returns the colour for a displacement on the surface and in the legend, blended over the tissue.
/// Grows lighter with the place.
Rgb displacementColour(double place, const Rgb& tissue);

/// Returns the colour for a pressure on the surface and in the legend: from green (tension) over
/// light grey (zero) to purple (compression). Colour-blind people can tell the ends apart, and the
/// colours differ from tissue, the arrow and an uncertain force. place: -1 to 1, share of the
/// scale.
Rgb pressureColour(double place);

}  // namespace palpate
