#include "viewer/picture/panel_style.hpp"

namespace palpate {

void setPanelStyle() {
  ImGui::StyleColorsLight();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = style.WindowBorderSize = 0;
  style.FrameRounding = 3;
  style.WindowPadding = {14, 12};
  style.ItemSpacing = {8, 5};
  style.Colors[ImGuiCol_Text] = ImGui::ColorConvertU32ToFloat4(ink);
  style.Colors[ImGuiCol_TextDisabled] = {0.42F, 0.45F, 0.51F, 1};
  style.Colors[ImGuiCol_FrameBg] = {0.90F, 0.915F, 0.935F, 1};
  style.Colors[ImGuiCol_Button] = {0.83F, 0.87F, 0.92F, 1};
  style.Colors[ImGuiCol_ButtonHovered] = {0.70F, 0.80F, 0.92F, 1};
  style.Colors[ImGuiCol_ButtonActive] = {0.55F, 0.71F, 0.90F, 1};
  style.Colors[ImGuiCol_CheckMark] = {0.09F, 0.33F, 0.66F, 1};
}

}  // namespace palpate
