#pragma once

#include <string>

#include "viewer/haptics/surface_pressures.hpp"

namespace palpate {

/// Why pressures cannot be seen, in a sentence that says which key of the scene would make them be
/// stored, or how long it takes; empty: they can.
std::string whyNoPressures(const SurfacePressures& pressures);

}  // namespace palpate
