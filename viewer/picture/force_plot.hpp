#pragma once

#include "viewer/picture/force_history.hpp"
#include "viewer/picture/stage.hpp"

namespace palpate {

/// Lays out the panel below the view: the force of the last ForceHistory::span seconds, its
/// components and its length, with the error bound as a band around it. view: what the panels leave
/// free, in ImGui's units.
void buildForcePlot(const ForceHistory& history, const Viewport& view);

}  // namespace palpate
