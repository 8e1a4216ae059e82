#pragma once

#include <span>
#include <string>
#include <vector>

#include "viewer/picture/label_place.hpp"
#include "viewer/picture/panel_contents.hpp"
#include "viewer/picture/panel_style.hpp"

namespace palpate {

// What drawViewOverlay() puts together, a source each. size: of the view, whose upper left is 0.

/// What the colours of the surface and of the lattice mean, at the lower left: of what is shown
/// alone. The part of the view that they take. size: of the view, or of its part above a hint.
ScreenBox drawLegends(ImDrawList& draw, const PanelContents& contents, const ViewChoices& choices,
                      ImVec2 size);
/// At the right above `foot` a length at the depth of the body, and the directions of the axes of
/// the scene.
void drawScaleAndAxes(ImDrawList& draw, const PanelContents& contents, ImVec2 size, float foot);

/// What is touched, at the upper right, a line each. The part of the window that it takes. left: of
/// the view.
ScreenBox drawNames(ImDrawList& draw, const std::vector<std::string>& names, float left,
                    float width);
/// Beyond the tip of its arrow, on a light ground. taken: where other words are.
void drawLabel(ImDrawList& draw, const ViewLabel& label, const OrbitCamera& camera, float left,
               ImVec2 size, std::span<const ScreenBox> taken);

/// Where a point of the scene is seen.
ImVec2 seenAt(const OrbitCamera& camera, const Eigen::Vector3d& point, ImVec2 size);

}  // namespace palpate
