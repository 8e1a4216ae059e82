#include "viewer/picture/legends.hpp"

#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

#include "viewer/fields/relative_error.hpp"
#include "viewer/picture/lattice_dots.hpp"
#include "viewer/picture/panel_style.hpp"
#include "viewer/plot/viridis.hpp"

namespace palpate {
namespace {

// px
constexpr float title_height = 22, bar_height = 150, bar_width = 12, word_gap = 7, half_word = 7;
constexpr float note_gap = 14, text_height = 18, ground = 3;
static_assert(bar_legend_height == title_height + bar_height + note_gap + text_height);
constexpr float tag_size = 9, tag_top = 3, tag_text_offset = 16;
static_assert(tag_legend_height == 4 * text_height);

ImU32 packed(const std::array<double, 3>& rgb) {
  return IM_COL32(static_cast<int>(rgb[0]), static_cast<int>(rgb[1]), static_cast<int>(rgb[2]),
                  255);
}

/// A bar of viridis from bottom to top, `size` large.
void colourBar(ImDrawList& draw, ImVec2 from, ImVec2 size) {
  constexpr int steps = 20;
  const float part = size.y / steps, bottom = from.y + size.y;
  for (int n = 0; n < steps; ++n) {
    const ImU32 low = packed(viridis(static_cast<double>(n) / steps));
    const ImU32 high = packed(viridis((n + 1.0) / steps));
    const float y = bottom - part * static_cast<float>(n);
    draw.AddRectFilledMultiColor({from.x, y - part}, {from.x + size.x, y}, high, high, low, low);
  }
}

/// on_dots: on a light ground, or the dots of the lattice would hide it.
void word(ImDrawList& draw, ImVec2 at, const std::string& text, bool on_dots, ImU32 colour = ink) {
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  if (on_dots)
    draw.AddRectFilled({at.x - ground, at.y}, {at.x + size.x + ground, at.y + size.y}, paper);
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

}  // namespace

void displacementLegend(ImDrawList& draw, ImVec2 at, double full, bool on_dots) {
  std::vector<BarLabel> labels;
  for (int n = 0; n <= 4; ++n) labels.push_back({0.25 * n, fmt::format("{:g}", 250 * full * n)});
  legendBar(draw, at, "displacement, mm", labels, on_dots);
  word(draw, {at.x, at.y + title_height + bar_height + note_gap}, "grey: nothing to feel", on_dots,
       faint);
}

void tagLegend(ImDrawList& draw, ImVec2 at) {
  for (const Tag tag : {Tag::expandable, Tag::terminating, Tag::failed, Tag::unknown}) {
    draw.AddRectFilled({at.x, at.y + tag_top}, {at.x + tag_size, at.y + tag_top + tag_size},
                       packed(colourOf(tag)));
    word(draw, {at.x + tag_text_offset, at.y}, std::string(name(tag)), true);
    at.y += text_height;
  }
}

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

}  // namespace palpate
