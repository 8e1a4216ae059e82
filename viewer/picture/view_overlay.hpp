#pragma once

#include "viewer/picture/panel_contents.hpp"
#include "viewer/picture/stage.hpp"

namespace palpate {

/// Draws over the view: names, the number at the arrow, legends, scale and axes, messages, the ring
/// of a hand without a device, and the hint. If the help is shown, it replaces the legends. If
/// another dataset is shown beside, draws its names and its number over the other half, or the
/// reason why nothing is touched there.
///
/// view: the part of the window without panels, in ImGui's units.
void drawViewOverlay(const PanelContents& contents, const ViewChoices& choices,
                     const Viewport& view);

}  // namespace palpate
