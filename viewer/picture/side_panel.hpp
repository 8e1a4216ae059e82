#pragma once

#include "viewer/picture/panel_contents.hpp"
#include "viewer/picture/picture_requests.hpp"
#include "viewer/picture/stage.hpp"

namespace palpate {

/// Lays out the panel at the right of the view, from top to bottom of the window: what the hand
/// feels, choices, and the numbers of lattice, tissue and loop. Changes `choices` and adds to
/// `requests` as the person clicks. view: what the panels leave free, in ImGui's units.
void buildSidePanel(const PanelContents& contents, const Viewport& view, ViewChoices& choices,
                    PictureRequests& requests);

}  // namespace palpate
