#pragma once

#include <imgui.h>

#include "viewer/picture/label_place.hpp"
#include "viewer/picture/panel_contents.hpp"

namespace palpate {

/// Draws what the colours of the surface and of the lattice mean, of what is shown alone, at the
/// lower left. The part of the view that they take. size: of the view, whose upper left is 0, or of
/// its part above a hint.
ScreenBox drawLegends(ImDrawList& draw, const PanelContents& contents, const ViewChoices& choices,
                      ImVec2 size);

}  // namespace palpate
