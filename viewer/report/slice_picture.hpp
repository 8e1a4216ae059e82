#pragma once

#include "viewer/plot/figure.hpp"
#include "viewer/report/colour_scale.hpp"
#include "viewer/report/node_pictures.hpp"

namespace palpate {

/// The map as an <svg> element, axes in mm.
std::string svgOf(const SliceMap& map, const ColourScale& scale);

/// The map with what its file needs below it; its numbers as a table of bounds (columns across,
/// rows up) and one of all marks.
Panel panelOf(const SliceMap& map, const ColourScale& scale, const std::string& caption);

/// The colours with their numbers, newtons, and what the marks mean, as HTML.
std::string legendOf(const ColourScale& scale);

}  // namespace palpate
