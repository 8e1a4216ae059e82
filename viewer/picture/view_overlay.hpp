#pragma once

#include "viewer/picture/panel_contents.hpp"
#include "viewer/picture/stage.hpp"

namespace palpate {

/// Draws over the view: names, the number at the arrow, legends, scale and axes, messages, the ring
/// of a hand without a device, and the hint. If the help is shown, it replaces the legends. If a
/// second dataset is shown beside the touched one, draws its names over its half, and the number at
/// its arrow or the reason why it is not touched.
///
/// view: the part of the window without panels, in ImGui's units.
void drawViewOverlay(const PanelContents& contents, const ViewChoices& choices,
                     const Viewport& view);

}  // namespace palpate
