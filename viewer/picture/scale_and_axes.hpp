#pragma once

#include <imgui.h>

#include "viewer/picture/panel_contents.hpp"

namespace palpate {

/// Draws a scale bar that is valid at the depth of the body, and the axes of the scene. Both are at
/// the right, above the height `foot`.
///
/// size: size of the view; its upper left corner is 0.
void drawScaleAndAxes(ImDrawList& draw, const PanelContents& contents, ImVec2 size, float foot);

}  // namespace palpate
