#pragma once

#include <imgui.h>

namespace palpate {

inline constexpr ImU32 ink = IM_COL32(38, 42, 52, 255), faint = IM_COL32(38, 42, 52, 130);
inline constexpr ImU32 red = IM_COL32(196, 30, 30, 255), blue = IM_COL32(24, 84, 170, 255);
/// Of a force that is uncertain; darker where it is text.
inline constexpr ImU32 amber = IM_COL32(240, 150, 10, 255), amber_ink = IM_COL32(158, 88, 0, 255);
inline constexpr ImU32 white = IM_COL32(255, 255, 255, 255), paper = IM_COL32(255, 255, 255, 225);
inline constexpr ImU32 line_grey = IM_COL32(214, 219, 227, 255);
/// Of the axes x, y, z, wherever they are.
inline constexpr ImU32 axis_colours[] = {IM_COL32(214, 84, 0, 255), IM_COL32(0, 140, 100, 255),
                                         IM_COL32(0, 104, 190, 255)};

/// Height of the text at a scale of 1, in ImGui's units.
inline constexpr float text_size = 15;
/// A length at a scale of 1, as it is at the scale of the screen: all of the panels goes with their
/// text.
inline float px(float length) { return length * ImGui::GetFontSize() / text_size; }

/// Panels that lie where they are put, on the ground that the stage cleared (Stage::render).
inline constexpr ImGuiWindowFlags fixed_panel =
    ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
    ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBackground |
    ImGuiWindowFlags_NoBringToFrontOnFocus;

/// Colours, paddings and spacings of all panels of the current ImGui context, and their font; again
/// when the scale changes, between two pictures. scale: pixels for each pixel of a screen of 96
/// dots per inch. units: pixels for each of ImGui's units. A font that is not installed is no
/// error: ImGui has one of its own.
void setPanelStyle(double scale, double units);

/// Words that can be read whatever is behind them: with a light rim. wrap: how wide a line of them
/// may be; 0: as wide as it is.
void drawRimmedText(ImDrawList& draw, ImVec2 at, ImU32 colour, const char* text, float wrap = 0);

}  // namespace palpate
