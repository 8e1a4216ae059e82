#include "viewer/picture/legends.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

#include "viewer/fields/relative_error.hpp"
#include "viewer/picture/lattice_dots.hpp"
#include "viewer/picture/panel_style.hpp"
#include "viewer/picture/touch_words.hpp"
#include "viewer/plot/round_numbers.hpp"
#include "viewer/plot/viridis.hpp"

namespace palpate {
namespace {

// px
constexpr float legend_margin = 18, lattice_legend_gap = 40;
constexpr float title_gap = 7, bar_width = 12, word_gap = 7, note_gap = 9;
constexpr float note_width = 156;  // leaves room for a hint beside the note
constexpr float swatch_size = 11, swatch_gap = 7;
constexpr float bar_share = 0.24F, shortest_bar = 64, longest_bar = 150;  // bar_share: of the
                                                                          // height of the view

ImU32 imColour(const Rgb& rgb) {
  return IM_COL32(static_cast<int>(rgb[0]), static_cast<int>(rgb[1]), static_cast<int>(rgb[2]),
                  255);
}

/// A legend that grows upward from its lower left corner. Its last entry must be added first.
class Legend {
 public:
  Legend(ImDrawList& draw, ImVec2 lower_left) : draw_(draw), at_(lower_left) {}

  void swatch(const Rgb& colour, const std::string& meaning, bool hatched = false) {
    at_.y -= line();
    const float top = at_.y + (line() - px(swatch_size)) / 2, size = px(swatch_size);
    draw_.AddRectFilled({at_.x, top}, {at_.x + size, top + size}, imColour(colour), px(2));
    for (const float part : {0.5F, 1.0F, 1.5F}) {
      const float from = std::max(0.0F, part - 1) * size, to = std::min(1.0F, part) * size;
      if (hatched)
        draw_.AddLine({at_.x + from, top + size - to}, {at_.x + to, top + size - from}, paper,
                      px(2));
    }
    word({at_.x + px(swatch_size + swatch_gap), at_.y}, meaning);
  }
  void gap() { at_.y -= px(note_gap); }
  /// Adds a sentence, wrapped into lines of its own.
  void note(const std::string& text) {
    const ImVec2 size = ImGui::CalcTextSize(text.c_str(), nullptr, false, px(note_width));
    at_.y -= size.y;
    drawRimmedText(draw_, at_, ink, text.c_str(), px(note_width));
    right_ = std::max(right_, at_.x + size.x);
  }

  struct Mark {
    double place;  ///< 0: bottom of the bar, 1: top
    std::string text;
    bool limit = false;  ///< drawn as a line across the bar
  };
  /// Adds a colour bar. colour: returns the colour at a place, 0 to 1.
  void bar(const char* title, float height, const std::function<Rgb(double)>& colour,
           const std::vector<Mark>& marks) {
    const float bottom = at_.y - line() / 2;
    colours({at_.x, bottom - height}, height, colour);
    for (const Mark& mark : marks) {
      const float y = bottom - height * static_cast<float>(mark.place);
      word({at_.x + px(bar_width + word_gap), y - line() / 2}, mark.text);
      if (mark.limit) draw_.AddLine({at_.x - px(2), y}, {at_.x + px(bar_width + 4), y}, ink, px(2));
    }
    at_.y = bottom - height - line() * 1.5F - px(title_gap);
    word(at_, title);
  }
  float width() const { return std::max(0.0F, right_ - at_.x); }
  float top() const { return at_.y; }

 private:
  static float line() { return ImGui::GetTextLineHeight(); }

  void word(ImVec2 at, const std::string& text) {
    drawRimmedText(draw_, at, ink, text.c_str());
    right_ = std::max(right_, at.x + ImGui::CalcTextSize(text.c_str()).x);
  }

  void colours(ImVec2 from, float height, const std::function<Rgb(double)>& colour) {
    constexpr int steps = 24;
    const float part = height / steps, bottom = from.y + height;
    for (int n = 0; n < steps; ++n) {
      const ImU32 low = imColour(colour(static_cast<double>(n) / steps));
      const ImU32 high = imColour(colour((n + 1.0) / steps));
      const float y = bottom - part * static_cast<float>(n);
      draw_.AddRectFilledMultiColor({from.x, y - part}, {from.x + px(bar_width), y}, high, high,
                                    low, low);
    }
  }

  ImDrawList& draw_;
  ImVec2 at_;
  float right_ = 0;
};

void displacementBar(Legend& legend, float height, double full) {
  std::vector<Legend::Mark> marks;
  for (int n = 0; n <= 4; ++n) marks.push_back({0.25 * n, fmt::format("{:g}", 250 * full * n)});
  legend.bar(
      "displacement, mm", height,
      [](double place) { return displacementColour(place, tissueColour(1)); }, marks);
}

void pressureBar(Legend& legend, float height, double full) {
  const auto mark = [full](double share, const char* meaning) {
    return Legend::Mark{0.5 + 0.5 * share, fmt::format("{:g}{}", 1e-3 * full * share, meaning)};
  };
  legend.bar("pressure, kPa", height, [](double place) { return pressureColour(2 * place - 1); },
             {mark(-1, "  tension"), mark(-0.5, ""), mark(0, ""), mark(0.5, ""),
              mark(1, "  compression")});
}

/// Adds a bar with the colours of error bounds (errorPlace).
void errorBar(Legend& legend, float height) {
  const auto mark = [](double error, const char* meaning) {
    return Legend::Mark{errorPlace(error), fmt::format("{:g}{}", 100 * error, meaning),
                        *meaning != '\0'};
  };
  legend.bar("error bound, % of the force", height, viridis,
             {mark(lowest_error, ""), mark(0.01, ""), mark(usual_force_error, "  usual target"),
              mark(noticeable_force_error, "  a hand notices"), mark(highest_error, "")});
}

/// Adds the meaning of the parts that are shown as tissue.
void tissueLegend(Legend& legend, const PanelContents& contents, SurfaceColour colour) {
  const SurfacePressures& known = contents.body.model().pressures();
  const std::string lack = colour == SurfaceColour::pressure ? whyNoPressures(known) : "";
  const bool pressures = colour == SurfaceColour::pressure && lack.empty();
  if (pressures && !known.everywhere()) {
    legend.swatch(tissueColour(1), "no pressure");
    legend.gap();
  }
  if (!lack.empty()) {
    legend.note(lack);
    legend.gap();
  }
  if (!contents.body.hasUntouchable() || (pressures && known.everywhere())) return;
  legend.swatch(tissueColour(0), "not touchable", true);
  if (colour == SurfaceColour::tissue || !lack.empty()) legend.swatch(tissueColour(1), "touchable");
  legend.gap();
}

void surfaceLegend(Legend& legend, const PanelContents& contents, SurfaceColour colour,
                   float bar_height) {
  tissueLegend(legend, contents, colour);
  if (colour == SurfaceColour::displacement)
    displacementBar(legend, bar_height, contents.body.fullColour());
  if (colour == SurfaceColour::error) errorBar(legend, bar_height);
  if (colour == SurfaceColour::pressure && contents.body.fullPressure() > 0)
    pressureBar(legend, bar_height, contents.body.fullPressure());
}

void latticeLegend(Legend& legend, bool errors, float bar_height) {
  if (errors) return errorBar(legend, bar_height);
  for (const Tag tag : {Tag::unknown, Tag::failed, Tag::terminating, Tag::expandable})
    legend.swatch(colourOf(tag), std::string(name(tag)));
}

// px
constexpr float corner_margin = 18, least_bar = 64, bar_tick = 4, bar_text_gap = 3;
constexpr float axis_length = 24, axes_room = 40, letter_gap = 7;

constexpr std::array<const char*, 3> axis_letters = {"x", "y", "z"};

void drawScale(ImDrawList& draw, const PanelContents& contents, ImVec2 size, ImVec2 right_end) {
  const Eigen::Vector3d& middle = contents.body.sphere().centre;
  const double metres = contents.camera.moveInPlane(middle, 0, 1).norm() / size.y;  // m per pixel
  if (!(metres > 0)) return;
  const double length = roundUp(px(least_bar) * metres);
  const ImVec2 left = {right_end.x - static_cast<float>(length / metres), right_end.y};
  draw.AddLine(left, right_end, ink, px(1.5F));
  for (const ImVec2& end : {left, right_end})
    draw.AddLine({end.x, end.y - px(bar_tick)}, {end.x, end.y + px(bar_tick)}, ink, px(1.5F));
  const std::string text = fmt::format("{:g} mm", 1e3 * length);
  const ImVec2 words = ImGui::CalcTextSize(text.c_str());
  drawRimmedText(draw, {(left.x + right_end.x - words.x) / 2, left.y - words.y - px(bar_text_gap)},
                 ink, text.c_str());
}

void drawAxes(ImDrawList& draw, const OrbitCamera& camera, ImVec2 at) {
  const Eigen::Matrix3d seen = camera.axes().transpose();  // the columns are the axes of the scene
  std::array<int, 3> order{};
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](int axis) { return seen(2, axis); });  // begin with the farthest
  for (const int axis : order) {
    const auto place = [&](float length) {
      return ImVec2{at.x + length * static_cast<float>(seen(0, axis)),
                    at.y - length * static_cast<float>(seen(1, axis))};
    };
    const auto n = static_cast<std::size_t>(axis);
    draw.AddLine(at, place(px(axis_length)), axis_colours[n], px(2));
    const ImVec2 words = ImGui::CalcTextSize(axis_letters[n]),
                 end = place(px(axis_length + letter_gap));
    drawRimmedText(draw, {end.x - words.x / 2, end.y - words.y / 2}, axis_colours[n],
                   axis_letters[n]);
  }
}

}  // namespace

ScreenBox drawLegends(ImDrawList& draw, const PanelContents& contents, const ViewChoices& choices,
                      ImVec2 size) {
  const float bar_height = std::clamp(bar_share * size.y, px(shortest_bar), px(longest_bar));
  const ImVec2 corner = {px(legend_margin), size.y - px(legend_margin)};
  Legend surface(draw, corner);
  surfaceLegend(surface, contents, choices.colour, bar_height);
  float right = corner.x + surface.width(), top = surface.top();
  if (choices.lattice) {
    const float left = surface.width() > 0 ? right + px(lattice_legend_gap) : corner.x;
    Legend lattice(draw, {left, corner.y});
    latticeLegend(lattice, choices.errors, bar_height);
    right = left + lattice.width();
    top = std::min(top, lattice.top());
  }
  return {{corner.x, top}, {right, corner.y}};
}

void drawScaleAndAxes(ImDrawList& draw, const PanelContents& contents, ImVec2 size, float foot) {
  const ImVec2 corner = {size.x - px(corner_margin), foot - px(corner_margin)};
  drawAxes(draw, contents.camera, {corner.x - px(axes_room / 2), corner.y - px(axes_room / 2)});
  drawScale(draw, contents, size, {corner.x - px(axes_room + 2 * corner_margin), corner.y});
}

}  // namespace palpate
