#include <fmt/format.h>
#include <imgui.h>

#include <array>
#include <string>
#include <vector>

#include "viewer/fields/relative_error.hpp"
#include "viewer/picture/lattice_dots.hpp"
#include "viewer/picture/panel_style.hpp"
#include "viewer/picture/panels.hpp"
#include "viewer/plot/viridis.hpp"

namespace palpate {
namespace {

// px
constexpr float margin = 14, help_width = 60;
constexpr float legend_margin = 18, lattice_legend_left = 190;
constexpr float label_offset = 12, label_padding_x = 5, label_padding_y = 3, half_label = 7;
// Of the legends.
constexpr float title_height = 22, bar_height = 150, bar_width = 12, word_gap = 7, half_word = 7;
constexpr float note_gap = 14, text_height = 18, word_ground = 3;
constexpr float bar_legend_height = title_height + bar_height + note_gap + text_height;
constexpr float tag_size = 9, tag_top = 3, tag_text_offset = 16;
constexpr float tag_legend_height = 4 * text_height;
constexpr float banner_stripe = 4, banner_left = 12, banner_right = 8, banner_padding = 6,
                banner_gap = 6;

/// Beside its point, on a light ground.
void drawLabel(ImDrawList& draw, const ViewLabel& label, const OrbitCamera& camera, ImVec2 size) {
  const Eigen::Vector3d place = camera.project(label.at);
  if (label.text.empty() || !(place.z() > 0)) return;
  const ImVec2 at = {size.x / 2 + size.y * static_cast<float>(place.x()) + label_offset,
                     size.y / 2 - size.y * static_cast<float>(place.y()) - half_label};
  const ImVec2 text = ImGui::CalcTextSize(label.text.c_str());
  draw.AddRectFilled({at.x - label_padding_x, at.y - label_padding_y},
                     {at.x + text.x + label_padding_x, at.y + text.y + label_padding_y}, paper, 3);
  draw.AddText(at, ink, label.text.c_str());
}

ImU32 imColour(const std::array<double, 3>& rgb) {
  return IM_COL32(static_cast<int>(rgb[0]), static_cast<int>(rgb[1]), static_cast<int>(rgb[2]),
                  255);
}

/// A bar of viridis from bottom to top, `size` large.
void colourBar(ImDrawList& draw, ImVec2 from, ImVec2 size) {
  constexpr int steps = 20;
  const float part = size.y / steps, bottom = from.y + size.y;
  for (int n = 0; n < steps; ++n) {
    const ImU32 low = imColour(viridis(static_cast<double>(n) / steps));
    const ImU32 high = imColour(viridis((n + 1.0) / steps));
    const float y = bottom - part * static_cast<float>(n);
    draw.AddRectFilledMultiColor({from.x, y - part}, {from.x + size.x, y}, high, high, low, low);
  }
}

/// on_dots: on a light ground, or the dots of the lattice would hide it.
void word(ImDrawList& draw, ImVec2 at, const std::string& text, bool on_dots, ImU32 colour = ink) {
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  if (on_dots)
    draw.AddRectFilled({at.x - word_ground, at.y}, {at.x + size.x + word_ground, at.y + size.y},
                       paper);
  draw.AddText(at, colour, text.c_str());
}

struct BarLabel {
  double place;  ///< 0: at the bottom of the bar, 1: at its top
  std::string text;
  bool limit = false;  ///< drawn as a line across the bar
};

void legendBar(ImDrawList& draw, ImVec2 at, const char* title, const std::vector<BarLabel>& labels,
               bool on_dots) {
  word(draw, at, title, on_dots);
  const ImVec2 bar = {at.x, at.y + title_height};
  colourBar(draw, bar, {bar_width, bar_height});
  for (const BarLabel& label : labels) {
    const float y = bar.y + bar_height * (1 - static_cast<float>(label.place));
    word(draw, {bar.x + bar_width + word_gap, y - half_word}, label.text, on_dots);
    if (label.limit) draw.AddLine({bar.x - 2, y}, {bar.x + bar_width + 4, y}, ink, 2);
  }
}

/// What the colours of the surface mean, `at` its upper left. full: m, at the end of the colours.
/// on_dots: it lies over the lattice.
void displacementLegend(ImDrawList& draw, ImVec2 at, double full, bool on_dots) {
  std::vector<BarLabel> labels;
  for (int n = 0; n <= 4; ++n) labels.push_back({0.25 * n, fmt::format("{:g}", 250 * full * n)});
  legendBar(draw, at, "displacement, mm", labels, on_dots);
  word(draw, {at.x, at.y + title_height + bar_height + note_gap}, "grey: nothing to feel", on_dots,
       faint);
}

/// What the colours of the lattice by tag mean.
void tagLegend(ImDrawList& draw, ImVec2 at) {
  for (const Tag tag : {Tag::expandable, Tag::terminating, Tag::failed, Tag::unknown}) {
    draw.AddRectFilled({at.x, at.y + tag_top}, {at.x + tag_size, at.y + tag_top + tag_size},
                       imColour(colourOf(tag)));
    word(draw, {at.x + tag_text_offset, at.y}, std::string(name(tag)), true);
    at.y += text_height;
  }
}

/// What the colours of the lattice by error mean (errorPlace).
void errorLegend(ImDrawList& draw, ImVec2 at) {
  const auto label = [](double error, const char* meaning) {
    return BarLabel{errorPlace(error), fmt::format("{:g}{}", 100 * error, meaning),
                    *meaning != '\0'};
  };
  legendBar(draw, at, "error bound, % of the force",
            {label(lowest_error, ""), label(0.01, ""), label(usual_force_error, "  usual target"),
             label(noticeable_force_error, "  a hand notices"), label(highest_error, "")},
            true);
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
  // Only where nothing else is said: it would lie below the banners.
  if (next == margin) draw.AddText({width - help_width, margin}, faint, "H: help");
}

}  // namespace

void drawViewOverlay(const PanelContents& contents, const ViewChoices& choices,
                     const Viewport& view) {
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const ImVec2 size = {static_cast<float>(view.width), static_cast<float>(view.height)};
  draw.PushClipRect({0, 0}, size);
  drawLabel(draw, contents.label, contents.camera, size);
  drawLegends(draw, contents, choices, size.y);
  drawBanners(draw, contents.status, choices.help, size.x);
  draw.PopClipRect();
}

}  // namespace palpate
