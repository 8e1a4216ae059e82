#pragma once

#include "viewer/picture/force_history.hpp"
#include "viewer/picture/stage.hpp"

namespace palpate {

/// The panel below the view: the force of the last ForceHistory::span seconds, its components and
/// its length. view: what the panels leave free, in ImGui's units.
void buildForcePlot(const ForceHistory& history, const Viewport& view);

}  // namespace palpate
