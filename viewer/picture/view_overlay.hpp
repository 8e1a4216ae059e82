#pragma once

#include "viewer/picture/panel_contents.hpp"
#include "viewer/picture/stage.hpp"

namespace palpate {

/// Draws over the view: names, the number at the arrow, legends, scale and axes, ring and hint of a
/// hand without a device, and messages. The help replaces the legends. If another dataset is shown
/// beside, draws its names and number over the other half, and why nothing is touched there. view:
/// the area without panels, in ImGui's units.
void drawViewOverlay(const PanelContents& contents, const ViewChoices& choices,
                     const Viewport& view);

}  // namespace palpate
