#pragma once

#include "viewer/picture/panel_contents.hpp"
#include "viewer/picture/stage.hpp"

namespace palpate {

/// Draws what lies over the view: names, the number at the arrow, legends, scale and axes, ring and
/// hint of a hand without a device, what must be said, the help (which legends make room for); over
/// its other half, where another dataset is shown beside, names and number of that one, and why
/// nothing is touched there. view: what the panels leave free, in ImGui's units.
void drawViewOverlay(const PanelContents& contents, const ViewChoices& choices,
                     const Viewport& view);

}  // namespace palpate
