#pragma once

#include <imgui.h>

#include "viewer/picture/label_place.hpp"
#include "viewer/picture/panel_contents.hpp"

namespace palpate {

/// Draws the legends of the colours that surface and lattice show, at the lower left. Returns the
/// part of the view that they cover.
///
/// size: size of the part of the view to draw in; its upper left corner is 0.
ScreenBox drawLegends(ImDrawList& draw, const PanelContents& contents, const ViewChoices& choices,
                      ImVec2 size);

/// Draws a scale bar that is valid at the depth of the body, and the axes of the scene. Both are at
/// the right, above the height `foot`.
///
/// size: size of the view; its upper left corner is 0.
void drawScaleAndAxes(ImDrawList& draw, const PanelContents& contents, ImVec2 size, float foot);

}  // namespace palpate
