#pragma once

#include "viewer/picture/panel_contents.hpp"
#include "viewer/picture/stage.hpp"

namespace palpate {

/// What lies over the view: labels, legends, what must be said, the help. view: what the panels
/// leave free, in ImGui's units.
void drawViewOverlay(const PanelContents& contents, const ViewChoices& choices,
                     const Viewport& view);

}  // namespace palpate
