#include "viewer/picture/view_overlay.hpp"

#include <imgui.h>

#include <string>

#include "viewer/picture/legends.hpp"
#include "viewer/picture/panel_style.hpp"
#include "viewer/picture/view_keys.hpp"

namespace palpate {
namespace {

// px
constexpr float margin = 14, help_width = 60;
constexpr float legend_margin = 18, lattice_legend_left = 190;
constexpr float label_offset = 12, label_padding_x = 5, label_padding_y = 3, half_label = 7;
constexpr float banner_stripe = 4, banner_left = 12, banner_right = 8, banner_padding = 6,
                banner_gap = 6;

/// Beside its point, on a light ground.
void drawLabel(ImDrawList& draw, const ViewLabel& label, const OrbitCamera& camera, ImVec2 size) {
  const Eigen::Vector3d place = camera.project(label.at);
  if (!(place.z() > 0)) return;
  const ImVec2 at = {size.x / 2 + size.y * static_cast<float>(place.x()) + label_offset,
                     size.y / 2 - size.y * static_cast<float>(place.y()) - half_label};
  const ImVec2 text = ImGui::CalcTextSize(label.text.c_str());
  draw.AddRectFilled({at.x - label_padding_x, at.y - label_padding_y},
                     {at.x + text.x + label_padding_x, at.y + text.y + label_padding_y}, paper, 3);
  draw.AddText(at, ink, label.text.c_str());
}

void drawLegends(ImDrawList& draw, const PanelContents& contents, const ViewChoices& choices,
                 float bottom) {
  const float bars = bottom - legend_margin - bar_legend_height;
  displacementLegend(draw, {legend_margin, bars}, contents.full_colour, choices.lattice);
  if (!choices.lattice) return;
  if (choices.errors)
    errorLegend(draw, {lattice_legend_left, bars});
  else
    tagLegend(draw, {lattice_legend_left, bottom - legend_margin - tag_legend_height});
}

/// Text on a light ground, as wide as the view at most; tells where the next may begin.
float banner(ImDrawList& draw, ImVec2 at, float width, ImU32 colour, const std::string& text) {
  const float wrap = width - banner_left - banner_right;
  const ImVec2 size = ImGui::CalcTextSize(text.c_str(), nullptr, false, wrap);
  const float bottom = at.y + size.y + 2 * banner_padding;
  draw.AddRectFilled(at, {at.x + size.x + banner_left + banner_right, bottom}, paper, 4);
  draw.AddRectFilled(at, {at.x + banner_stripe, bottom}, colour, 2);
  draw.AddText(ImGui::GetFont(), ImGui::GetFontSize(), {at.x + banner_left, at.y + banner_padding},
               colour, text.c_str(), nullptr, wrap);
  return bottom + banner_gap;
}

void drawBanners(ImDrawList& draw, const PictureStatus& status, bool help, float width) {
  float next = margin;
  const auto say = [&](ImU32 colour, const std::string& text) {
    if (!text.empty()) next = banner(draw, {margin, next}, width - 2 * margin, colour, text);
  };
  say(red, status.trouble);
  say(blue, status.notice);
  say(blue, status.paused ? "paused" : "");
  say(ink, help ? key_help : "");
  if (next == margin) draw.AddText({width - help_width, margin}, faint, "H: help");
}

}  // namespace

void drawViewOverlay(const PanelContents& contents, const ViewChoices& choices,
                     const Viewport& view) {
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const ImVec2 size = {static_cast<float>(view.width), static_cast<float>(view.height)};
  draw.PushClipRect({0, 0}, size);
  for (const ViewLabel& label : contents.labels) drawLabel(draw, label, contents.camera, size);
  drawLegends(draw, contents, choices, size.y);
  drawBanners(draw, contents.status, choices.help, size.x);
  draw.PopClipRect();
}

}  // namespace palpate
