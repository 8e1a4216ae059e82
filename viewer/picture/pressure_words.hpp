#pragma once

#include <string>

#include "viewer/haptics/surface_pressures.hpp"

namespace palpate {

/// Returns a sentence that says why pressures are not shown. It names the key of the scene that
/// would store them, or gives the progress of their preparation. Empty if they can be shown.
std::string whyNoPressures(const SurfacePressures& pressures);

}  // namespace palpate
