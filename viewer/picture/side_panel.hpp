#pragma once

#include "viewer/picture/panel_contents.hpp"
#include "viewer/picture/picture_requests.hpp"
#include "viewer/picture/stage.hpp"

namespace palpate {

/// The panel at the right of the view, from top to bottom of the window: choices, and the numbers
/// of touch, guards, loop and lattice. Changes `chosen` and adds to `requests` as the person
/// clicks. view: what the panels leave free, in ImGui's units.
void buildSidePanel(const PanelContents& contents, const Viewport& view, ViewChoices& chosen,
                    PictureRequests& requests);

}  // namespace palpate
