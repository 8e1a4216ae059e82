#pragma once

#include <string>

#include "viewer/haptics/surface_pressures.hpp"

namespace palpate {

/// Returns a sentence about why pressures are not shown: the key of the scene that would store
/// them, or the progress of their preparation. Empty if they can be shown.
std::string whyNoPressures(const SurfacePressures& pressures);

}  // namespace palpate
