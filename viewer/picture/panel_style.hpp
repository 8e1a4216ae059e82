#pragma once

#include <imgui.h>

namespace palpate {

inline constexpr ImU32 ink = IM_COL32(38, 42, 52, 255), faint = IM_COL32(38, 42, 52, 130);
inline constexpr ImU32 red = IM_COL32(196, 30, 30, 255), blue = IM_COL32(24, 84, 170, 255);
/// Colours of an uncertain force; amber_ink is darker, for text.
inline constexpr ImU32 amber = IM_COL32(240, 150, 10, 255), amber_ink = IM_COL32(158, 88, 0, 255);
inline constexpr ImU32 white = IM_COL32(255, 255, 255, 255), paper = IM_COL32(255, 255, 255, 225);
inline constexpr ImU32 line_grey = IM_COL32(214, 219, 227, 255);
/// Colours of the axes x, y and z in the plot and in the view.
inline constexpr ImU32 axis_colours[] = {IM_COL32(214, 84, 0, 255), IM_COL32(0, 140, 100, 255),
                                         IM_COL32(0, 104, 190, 255)};

/// Height of the text at scale 1, in ImGui's units.
inline constexpr float text_size = 15;
/// Converts a length at scale 1 to the current scale. Everything in the panels scales with the
/// text.
inline float px(float length) { return length * ImGui::GetFontSize() / text_size; }

/// Flags of panels with a fixed place. The panels draw no background; Stage::render() draws it.
inline constexpr ImGuiWindowFlags fixed_panel =
    ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
    ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBackground |
    ImGuiWindowFlags_NoBringToFrontOnFocus;

/// Sets the colours, paddings, spacings and font of all panels of the current ImGui context. If the
/// scale changes, call it again between two frames.
///
/// scale: pixels per pixel of a 96 dpi screen. units: pixels per ImGui unit. If none of the fonts
/// is installed, ImGui's own font is used.
void setPanelStyle(double scale, double units);

/// Draws text with a light rim, so that it is readable on any background. wrap: width of a line; 0
/// if there is no limit.
void drawRimmedText(ImDrawList& draw, ImVec2 at, ImU32 colour, const char* text, float wrap = 0);

}  // namespace palpate
