#pragma once

#include "viewer/picture/panel_contents.hpp"
#include "viewer/picture/stage.hpp"

namespace palpate {

/// Lays out the panel at the right of the view, over the full height of the window. It shows the
/// touch, the choices, and numbers about lattice, tissue and loop. Changes `choices` according to
/// the user's clicks, and adds requests to `requests`. view: the part of the window without panels,
/// in ImGui's units.
void buildSidePanel(const PanelContents& contents, const Viewport& view, ViewChoices& choices,
                    PictureRequests& requests);

}  // namespace palpate
