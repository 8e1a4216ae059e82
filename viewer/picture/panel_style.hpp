#pragma once

#include <imgui.h>

namespace palpate {

inline constexpr ImU32 ink = IM_COL32(38, 42, 52, 255), faint = IM_COL32(38, 42, 52, 110);
inline constexpr ImU32 red = IM_COL32(196, 30, 30, 255), blue = IM_COL32(24, 84, 170, 255);
inline constexpr ImU32 paper = IM_COL32(255, 255, 255, 225);
inline constexpr ImU32 line_grey = IM_COL32(214, 219, 227, 255);

/// Panels that lie where they are put, on the ground that the stage cleared (Stage::render).
inline constexpr ImGuiWindowFlags fixed_panel =
    ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
    ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBackground |
    ImGuiWindowFlags_NoBringToFrontOnFocus;

}  // namespace palpate
