#pragma once

#include <imgui.h>

#include "viewer/picture/panel_contents.hpp"

namespace palpate {

/// Draws a scale bar for the depth of the body, and the axes of the scene, at the right above
/// `foot`.
///
/// size: of the view, whose upper left corner is 0.
void drawScaleAndAxes(ImDrawList& draw, const PanelContents& contents, ImVec2 size, float foot);

}  // namespace palpate
