#include "viewer/picture/view_overlay.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "viewer/picture/label_place.hpp"
#include "viewer/picture/panels.hpp"

namespace palpate {
namespace {

// px
constexpr float margin = 14;
constexpr float label_padding_x = 7, label_padding_y = 4, arrow_width = 6;
constexpr float banner_stripe = 4, banner_left = 12, banner_right = 8, banner_padding = 6,
                banner_gap = 6;
constexpr double view_edge = 4;

Eigen::Vector2d screenPoint(ImVec2 at) { return {at.x, at.y}; }
ImVec2 imPoint(const Eigen::Vector2d& at) {
  return {static_cast<float>(at.x()), static_cast<float>(at.y())};
}

/// What is touched, at the upper right, and how to learn more; where that is, for the label.
ThickLine drawNames(ImDrawList& draw, const PanelContents& contents, float width) {
  const float line = ImGui::GetTextLineHeightWithSpacing(), right = width - px(margin);
  float y = px(margin), left = right;
  for (const auto& [text, colour] : {std::pair<const char*, ImU32>{contents.dataset.c_str(), ink},
                                     {contents.tissue.c_str(), faint},
                                     {"H: help", faint}}) {
    const float wide = ImGui::CalcTextSize(text).x;
    if (wide > width / 2) continue;
    draw.AddText({right - wide, y}, colour, text);
    left = std::min(left, right - wide);
    y += line;
  }
  const double middle = (px(margin) + y) / 2;
  return {{left, middle}, {right, middle}, (y - px(margin)) / 2};
}

/// Beyond the tip of the arrow, on a light ground.
void drawLabel(ImDrawList& draw, const ViewLabel& label, const OrbitCamera& camera, ImVec2 size,
               const ThickLine& names) {
  const double depth = camera.project(label.at).z();
  if (label.text.empty() || !(depth > 0)) return;
  const auto seen = [&](const Eigen::Vector3d& point) {
    return screenPoint(seenAt(camera, point, size));
  };
  const ThickLine arrow = {seen(label.from), seen(label.at), px(arrow_width)};
  const double pixels = size.y / camera.moveInPlane(label.tool[0], 0, 1).norm();  // per metre
  const ThickLine tool = {seen(label.tool[0]), seen(label.tool[1]), pixels * label.tool_radius};
  const ImVec2 text = ImGui::CalcTextSize(label.text.c_str());
  const Eigen::Vector2d padding(px(label_padding_x), px(label_padding_y));
  const Eigen::Vector2d edge(view_edge, view_edge);
  const ScreenBox box = placeLabel(arrow, screenPoint(text) + 2 * padding,
                                   {edge, screenPoint(size) - edge}, std::array{tool, names});
  draw.AddRectFilled(imPoint(box.from), imPoint(box.to), paper, px(4));
  draw.AddText(imPoint(box.from + padding), label.uncertain ? amber_ink : ink, label.text.c_str());
}

/// Text on a light ground, as wide as the view at most; tells where the next may begin.
float banner(ImDrawList& draw, ImVec2 at, float width, ImU32 colour, const std::string& text) {
  const float wrap = width - px(banner_left) - px(banner_right);
  const ImVec2 size = ImGui::CalcTextSize(text.c_str(), nullptr, false, wrap);
  const float bottom = at.y + size.y + 2 * px(banner_padding);
  draw.AddRectFilled(at, {at.x + size.x + px(banner_left) + px(banner_right), bottom}, paper,
                     px(4));
  draw.AddRectFilled(at, {at.x + px(banner_stripe), bottom}, colour, px(2));
  draw.AddText(ImGui::GetFont(), ImGui::GetFontSize(),
               {at.x + px(banner_left), at.y + px(banner_padding)}, colour, text.c_str(), nullptr,
               wrap);
  return bottom + px(banner_gap);
}

void drawBanners(ImDrawList& draw, const PictureStatus& status, bool help, float width) {
  float next = px(margin);
  const auto say = [&](ImU32 colour, const std::string& text) {
    if (!text.empty())
      next = banner(draw, {px(margin), next}, width - 2 * px(margin), colour, text);
  };
  say(red, status.trouble);
  say(blue, status.notice);
  say(blue, status.paused ? "paused" : "");
  say(ink, help ? key_help : "");
}

}  // namespace

ImVec2 seenAt(const OrbitCamera& camera, const Eigen::Vector3d& point, ImVec2 size) {
  const Eigen::Vector3d place = camera.project(point);
  return {size.x / 2 + size.y * static_cast<float>(place.x()),
          size.y / 2 - size.y * static_cast<float>(place.y())};
}

void drawViewOverlay(const PanelContents& contents, const ViewChoices& choices,
                     const Viewport& view) {
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const ImVec2 size = {static_cast<float>(view.width), static_cast<float>(view.height)};
  draw.PushClipRect({0, 0}, size);
  drawScaleAndAxes(draw, contents, size);
  drawLegends(draw, contents, choices, size);
  const ThickLine names = drawNames(draw, contents, size.x);
  drawLabel(draw, contents.label, contents.camera, size, names);
  drawBanners(draw, contents.status, choices.help, size.x);
  draw.PopClipRect();
}

}  // namespace palpate
