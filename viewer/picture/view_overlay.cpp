#include "viewer/picture/view_overlay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "viewer/picture/label_place.hpp"
#include "viewer/picture/panels.hpp"
#include "viewer/picture/sentence.hpp"

namespace palpate {
namespace {

// px
constexpr float margin = 14;
constexpr float label_padding_x = 7, label_padding_y = 4, arrow_width = 6;
constexpr float banner_stripe = 4, banner_left = 12, banner_right = 8, banner_padding = 6,
                banner_gap = 6;
constexpr float help_gap = 18, hint_above = 18, hint_above_scale = 84;
constexpr float narrow_view = 760;  // in which legends and scale stand above the hint
constexpr double view_edge = 4;
constexpr float widest_name = 0.7F;  // of the view: beyond it would lie under what is said

Eigen::Vector2d screenPoint(ImVec2 at) { return {at.x, at.y}; }
ImVec2 imPoint(const Eigen::Vector2d& at) {
  return {static_cast<float>(at.x()), static_cast<float>(at.y())};
}

/// The first line of a text, or its beginning and three dots where all of it would be wider.
std::string shortened(const std::string& text, float widest) {
  constexpr const char* dots = "...";
  std::string line = text.substr(0, text.find('\n'));
  const char* const end = line.data() + line.size();
  const auto endWithin = [&](float width) {
    const char* fits = nullptr;
    ImGui::GetFont()->CalcTextSizeA(ImGui::GetFontSize(), width, 0, line.data(), end, &fits);
    return fits;
  };
  if (endWithin(widest) == end) return line;
  const char* const cut = endWithin(widest - ImGui::CalcTextSize(dots).x);
  line.resize(static_cast<std::size_t>(cut - line.data()));
  return line + dots;
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

/// The keys in a column, what they do in another: in the text two spaces or more are between them.
/// Over all else, in as many such pairs of columns as a window of that height needs, and in smaller
/// letters where its width has no room for them.
void drawHelp(ImVec2 at, ImVec2 window) {
  std::vector<std::array<std::string, 2>> lines;
  std::istringstream text(key_help);
  float keys = 0, widest = 0;
  for (std::string line; std::getline(text, line);) {
    const std::size_t gap = std::min(line.find("  "), line.size());
    const std::size_t words = std::min(line.find_first_not_of(' ', gap), line.size());
    lines.push_back({line.substr(0, gap), line.substr(words)});
    keys = std::max(keys, ImGui::CalcTextSize(lines.back()[0].c_str()).x + px(help_gap));
    widest = std::max(widest, ImGui::CalcTextSize(lines.back()[1].c_str()).x);
  }
  const float step = ImGui::GetTextLineHeightWithSpacing(), wide = keys + widest + px(help_gap);
  const float room = (window.y - at.y - px(margin) - 2 * px(banner_padding)) / step;
  const auto rows = static_cast<std::size_t>(
      std::clamp(std::floor(room), 1.0F, static_cast<float>(lines.size())));
  const std::size_t columns = (lines.size() + rows - 1) / rows;
  const ImVec2 size = {wide * static_cast<float>(columns) + px(banner_left),
                       step * static_cast<float>(rows) + 2 * px(banner_padding)};
  const float smaller = std::min(1.0F, (window.x - at.x - px(margin)) / size.x);
  ImDrawList& draw = *ImGui::GetForegroundDrawList();
  draw.AddRectFilled(at, {at.x + smaller * size.x, at.y + size.y}, white, px(4));
  const auto write = [&](float x, float y, ImU32 colour, const std::string& words) {
    draw.AddText(ImGui::GetFont(), smaller * ImGui::GetFontSize(), {at.x + smaller * x, at.y + y},
                 colour, words.c_str());
  };
  for (std::size_t n = 0; n < lines.size(); ++n) {
    const std::size_t column = n / rows;
    const float x = px(banner_left) + wide * static_cast<float>(column),
                y = px(banner_padding) + step * static_cast<float>(n % rows);
    write(x, y, blue, lines[n][0]);
    write(x + keys, y, ink, lines[n][1]);
  }
}

/// Why B shows nothing.
const char* besideNothing(const PanelContents& contents, const ViewChoices& choices) {
  return choices.beside && contents.models.size() == 1
             ? "B shows another dataset beside this one; there is none (palpate view A.h5 "
               "B.h5). B again hides this."
             : "";
}

void drawBanners(ImDrawList& draw, const PanelContents& contents, const ViewChoices& choices,
                 const Viewport& view) {
  const PictureStatus& status = contents.status;
  const auto width = static_cast<float>(view.width);
  float next = px(margin);
  const auto say = [&](ImU32 colour, const std::string& text) {
    if (!text.empty())
      next = banner(draw, {px(margin), next}, width - 2 * px(margin), colour, text);
  };
  say(red, status.trouble);
  say(blue, status.notice);
  say(blue, status.paused ? "paused" : "");
  say(blue, besideNothing(contents, choices));
  if (choices.help)
    drawHelp({px(margin), next},
             {static_cast<float>(view.window_width), static_cast<float>(view.window_height)});
}

}  // namespace

ScreenBox drawNames(ImDrawList& draw, const std::vector<std::string>& names, float left,
                    float width) {
  const float line = ImGui::GetTextLineHeightWithSpacing(), right = left + width - px(margin);
  float y = px(margin), begin = right;
  for (const std::string& name : names) {
    const std::string shown = shortened(name, widest_name * width);
    const float wide = ImGui::CalcTextSize(shown.c_str()).x;
    drawRimmedText(draw, {right - wide, y}, &name == names.data() ? ink : faint, shown.c_str());
    begin = std::min(begin, right - wide);
    y += line;
  }
  return {{begin, px(margin)}, {right, y}};
}

void drawLabel(ImDrawList& draw, const ViewLabel& label, const OrbitCamera& camera, float left,
               ImVec2 size, std::span<const ScreenBox> taken) {
  const double depth = camera.project(label.at).z();
  if (label.text.empty() || !(depth > 0)) return;
  const Eigen::Vector2d origin(left, 0);
  const auto seen = [&](const Eigen::Vector3d& point) {
    return Eigen::Vector2d(origin + screenPoint(seenAt(camera, point, size)));
  };
  const ThickLine arrow = {seen(label.from), seen(label.at), px(arrow_width)};
  const double pixels = size.y / camera.moveInPlane(label.tool[0], 0, 1).norm();  // per metre
  const Eigen::Vector2d tip = seen(label.tool[0]), end = seen(label.tool[1]);
  const std::array<ThickLine, 2> tool = {
      {{tip, tip, pixels * label.tip_radius}, {tip, end, pixels * label.handle_radius}}};
  const ImVec2 text = ImGui::CalcTextSize(label.text.c_str());
  const Eigen::Vector2d padding(px(label_padding_x), px(label_padding_y));
  const Eigen::Vector2d edge(view_edge, view_edge);
  const ScreenBox box = placeLabel(arrow, screenPoint(text) + 2 * padding,
                                   {origin + edge, origin + screenPoint(size) - edge}, tool, taken);
  draw.AddRectFilled(imPoint(box.from), imPoint(box.to), paper, px(4));
  draw.AddText(imPoint(box.from + padding), label.uncertain ? amber_ink : ink, label.text.c_str());
}

ImVec2 seenAt(const OrbitCamera& camera, const Eigen::Vector3d& point, ImVec2 size) {
  const Eigen::Vector3d place = camera.project(point);
  return {size.x / 2 + size.y * static_cast<float>(place.x()),
          size.y / 2 - size.y * static_cast<float>(place.y())};
}

std::vector<ScreenBox> drawHint(const PanelContents& contents, const Viewport& view) {
  if (contents.hand.hint.empty()) return {};
  // Between two bodies is the scale of the first.
  const float above = contents.beside ? hint_above_scale : hint_above;
  return {drawSentence(*ImGui::GetBackgroundDrawList(), contents.hand.hint, view, px(above))};
}

void drawViewOverlay(const PanelContents& contents, const ViewChoices& choices,
                     const Viewport& view, const std::vector<ScreenBox>& hint) {
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const ImVec2 size = {static_cast<float>(view.width), static_cast<float>(view.height)};
  // Where a hint leaves them no room they stand above it.
  const bool narrow = size.x < px(narrow_view) && !hint.empty() && !contents.beside;
  const float foot = narrow ? static_cast<float>(hint.front().from.y()) : size.y;
  std::vector<ScreenBox> taken = hint;
  draw.PushClipRect({0, 0}, size);
  drawScaleAndAxes(draw, contents, size, foot);
  // The help covers a part of them, and a bar without its name and its numbers says nothing.
  if (!choices.help) taken.push_back(drawLegends(draw, contents, choices, {size.x, foot}));
  taken.push_back(drawNames(draw, {contents.dataset, contents.tissue, "H: help"}, 0, size.x));
  drawLabel(draw, contents.label, contents.camera, 0, size, taken);
  drawBanners(draw, contents, choices, view);
  draw.PopClipRect();
}

}  // namespace palpate
