#include "viewer/picture/panel_style.hpp"

#include <cmath>
#include <filesystem>

namespace palpate {
namespace {

/// Files of Debian's packages fonts-roboto-unhinted and fonts-dejavu-core. The digits of both fonts
/// have equal widths, so numbers do not jitter when they change.
constexpr const char* font_files[] = {
    "/usr/share/fonts/truetype/roboto/unhinted/RobotoTTF/Roboto-Regular.ttf",
    "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"};
constexpr float own_font_size = 13;  // native size of ImGui's own font
constexpr float rim = 1.4F;          // px

void addFont(ImFontAtlas& atlas, float scale) {
  std::error_code unreadable;
  for (const char* const file : font_files)
    if (std::filesystem::exists(file, unreadable) &&
        atlas.AddFontFromFileTTF(file, std::round(text_size * scale)) != nullptr)
      return;
  ImFontConfig config;
  config.SizePixels = std::round(own_font_size * scale);
  atlas.AddFontDefault(&config);
}

}  // namespace

void setPanelStyle(double scale, double units) {
  ImGuiIO& io = ImGui::GetIO();
  io.Fonts->Clear();
  addFont(*io.Fonts, static_cast<float>(scale));
  io.FontGlobalScale = static_cast<float>(1 / units);
  ImGuiStyle& style = ImGui::GetStyle();
  style = ImGuiStyle();
  ImGui::StyleColorsLight();
  style.WindowRounding = style.WindowBorderSize = 0;
  style.FrameRounding = 4;
  style.GrabRounding = 4;
  style.ScrollbarSize = 10;
  style.WindowPadding = {14, 12};
  style.FramePadding = {7, 3};
  style.ItemSpacing = {8, 3};
  style.ItemInnerSpacing = {5, 4};
  style.ScaleAllSizes(static_cast<float>(scale / units));
  style.Colors[ImGuiCol_Text] = ImGui::ColorConvertU32ToFloat4(ink);
  style.Colors[ImGuiCol_TextDisabled] = {0.42F, 0.45F, 0.51F, 1};
  style.Colors[ImGuiCol_FrameBg] = {0.90F, 0.915F, 0.935F, 1};
  style.Colors[ImGuiCol_Button] = {0.83F, 0.87F, 0.92F, 1};
  style.Colors[ImGuiCol_ButtonHovered] = {0.70F, 0.80F, 0.92F, 1};
  style.Colors[ImGuiCol_ButtonActive] = {0.55F, 0.71F, 0.90F, 1};
  style.Colors[ImGuiCol_CheckMark] = {0.09F, 0.33F, 0.66F, 1};
  style.Colors[ImGuiCol_ScrollbarBg] = {0, 0, 0, 0};
}

void drawRimmedText(ImDrawList& draw, ImVec2 at, ImU32 colour, const char* text, float wrap) {
  const auto write = [&](ImVec2 place, ImU32 with) {
    draw.AddText(ImGui::GetFont(), ImGui::GetFontSize(), place, with, text, nullptr, wrap);
  };
  const float r = px(rim);
  for (const float x : {-r, 0.0F, r})
    for (const float y : {-r, 0.0F, r})
      if (x != 0 || y != 0) write({at.x + x, at.y + y}, paper);
  write(at, colour);
}

}  // namespace palpate
