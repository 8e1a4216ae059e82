#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace palpate {

/// Red, green and blue, 0 to 255, in the screen's colour space.
using Rgb = std::array<double, 3>;

/// Quantity that colours the surface: none (tissue), displacement, relative error bound of the
/// force at a touch, or pressure.
enum class SurfaceColour : std::uint8_t { tissue, displacement, error, pressure };
/// The names that the user sees, in the order of SurfaceColour.
inline constexpr std::array surface_colours = {"tissue", "displacement", "error bound", "pressure"};
inline constexpr int surface_colour_count = surface_colours.size();
/// Returns the next quantity in the cycle.
inline SurfaceColour following(SurfaceColour colour) {
  return static_cast<SurfaceColour>((static_cast<int>(colour) + 1) % surface_colour_count);
}

/// Returns the colour of wet tissue.
///
/// felt: 1 for touchable tissue; 0 for other tissue, which is paler (and hatched, SoftLight).
/// blotch: 0 (darker) to 1 (lighter), for variation over the surface.
Rgb tissueColour(double felt, double blotch = 0.5);
/// Returns the blotch, 0 to 1, at a place of the body at rest. scaled: the place, in radii of the
/// body.
double blotchAt(const Eigen::Vector3d& scaled);

/// Returns 0 if x <= `from`, 1 if x >= `to`, and a smooth transition between them.
double smoothStep(double from, double to, double x);

/// Returns the opacity of a displacement's colour over the tissue. It is 0 without displacement,
/// and 1 from a fifth of the scale on. place: position on the scale, 0 to 1.
double displacementCover(double place);
/// Returns the colour of a displacement without the tissue below it. The scale runs from plum,
/// which is close to the colour of tissue, to the upper half of viridis.
Rgb displacementHue(double place);
/// Returns the colour of a displacement, blended over the tissue, for the surface and the legend.
/// It is lighter for larger displacements.
Rgb displacementColour(double place, const Rgb& tissue);

/// Returns the colour of a pressure for the surface and the legend: from green (tension) over light
/// grey (zero) to purple (compression). Colour-blind people can distinguish the two ends. The
/// colours also differ from those of tissue, arrow and uncertain force. place: position on the
/// scale, -1 to 1.
Rgb pressureColour(double place);

}  // namespace palpate
