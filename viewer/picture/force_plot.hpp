#pragma once

#include "viewer/picture/force_history.hpp"
#include "viewer/picture/stage.hpp"

namespace palpate {

/// Lays out the panel below the view. It shows the components and the magnitude of the force in the
/// last ForceHistory::span seconds, with the error bound as a band.
///
/// view: the part of the window without panels, in ImGui's units.
void buildForcePlot(const ForceHistory& history, const Viewport& view);

}  // namespace palpate
