#pragma once

#include <imgui.h>

namespace palpate {

/// Of a legend with a bar of colours, title and note included, px.
inline constexpr float bar_legend_height = 204;
/// Of the legend of tags, px.
inline constexpr float tag_legend_height = 72;

/// What the colours of the surface mean, `at` its upper left. full: m, at the end of the colours.
/// on_dots: it lies over the lattice.
void displacementLegend(ImDrawList& draw, ImVec2 at, double full, bool on_dots);
/// What the colours of the lattice by tag mean.
void tagLegend(ImDrawList& draw, ImVec2 at);
/// What the colours of the lattice by error mean (errorPlace), with the limits of usual_force_error
/// and noticeable_force_error.
void errorLegend(ImDrawList& draw, ImVec2 at);

}  // namespace palpate
