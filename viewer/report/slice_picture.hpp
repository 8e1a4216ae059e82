#pragma once

#include <string>

#include "viewer/report/colour_scale.hpp"
#include "viewer/report/slice_map.hpp"

namespace palpate {

/// The map as an <svg> element, axes in mm.
std::string svgOf(const SliceMap& map, const ColourScale& scale);

/// The colours with their numbers, newtons, and what the marks mean, as HTML.
std::string legendOf(const ColourScale& scale);

}  // namespace palpate
