#pragma once

#include <imgui.h>

#include "viewer/picture/label_place.hpp"
#include "viewer/picture/panel_contents.hpp"

namespace palpate {

/// Draws the legends for the colours of surface and lattice that are shown, at the lower left.
/// Returns the part of the view that they take.
///
/// size: of the view, whose upper left corner is 0, or of its part above a hint.
ScreenBox drawLegends(ImDrawList& draw, const PanelContents& contents, const ViewChoices& choices,
                      ImVec2 size);

}  // namespace palpate
