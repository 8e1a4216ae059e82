#include "viewer/picture/force_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "viewer/picture/panel_style.hpp"
#include "viewer/plot/round_numbers.hpp"

namespace palpate {
namespace {

// Layout of the curves and texts in the panel; px.
constexpr float margin_left = 48, margin_right = 28, margin_top = 32, margin_bottom = 24;
constexpr float legend_left = 14, legend_top = 8, legend_gap = 18;
constexpr float key_length = 16, key_gap = 5, band_height = 8;
constexpr float label_gap = 8, time_gap = 3;
constexpr float closest_points = 4;  // px, least distance between two points of a curve
constexpr float least_step = 26;     // px, least distance between two lines of the grid

constexpr double headroom = 1.08;       // upper end of the axis, relative to the largest force
constexpr double smallest_limit = 0.5;  // N: smallest end of the axis
constexpr int most_steps = 2;           // lines of the grid on either side of zero
constexpr std::array<ImU32, 4> curve_colours = {axis_colours[0], axis_colours[1], axis_colours[2],
                                                IM_COL32(30, 30, 36, 255)};
/// Names of the curves, then of the band.
constexpr std::array<const char*, 5> legend_names = {"x", "y", "z", "|F|", "error bound"};
constexpr const char* plot_title = "force on the tool, N";
constexpr const char* short_plot_title = "force, N";
constexpr ImU32 band_colour = IM_COL32(30, 30, 36, 46);

/// Maps times and forces to the screen.
struct PlotArea {
  ImVec2 from, to;
  double end = 0;    ///< time at the right edge, s
  double limit = 1;  ///< force at the upper edge, N; -limit is at the lower edge
  ImVec2 at(double time, double force) const {
    const double across = 1 - (end - time) / ForceHistory::span, up = 0.5 * (1 + force / limit);
    return {static_cast<float>(std::lerp(from.x, to.x, across)),
            static_cast<float>(std::lerp(to.y, from.y, up))};
  }
};

void plotGrid(ImDrawList& draw, const PlotArea& area) {
  // In a low panel there is room only for zero and the two ends.
  const int most = area.to.y - area.from.y > px(least_step) * 2 * most_steps ? most_steps : 1;
  const double step = roundUp(area.limit / most * 0.8);
  const int steps = static_cast<int>(area.limit / step * 1.001);
  for (int n = -steps; n <= steps; ++n) {
    const float y = area.at(area.end, n * step).y;
    draw.AddLine({area.from.x, y}, {area.to.x, y}, line_grey);
    const std::string text = fmt::format("{:g}", n * step);
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    draw.AddText({area.from.x - px(label_gap) - size.x, y - size.y / 2}, faint, text.c_str());
  }
  for (int second = 0; second <= static_cast<int>(ForceHistory::span); ++second) {
    const float x = area.at(area.end - second, 0).x;
    draw.AddLine({x, area.from.y}, {x, area.to.y}, line_grey);
    const std::string text = second == 0 ? "now" : fmt::format("-{} s", second);
    draw.AddText({x - ImGui::CalcTextSize(text.c_str()).x / 2, area.to.y + px(time_gap)}, faint,
                 text.c_str());
  }
}

/// Draws the error bound as a band around the magnitude. Draws nothing where the bound is unknown.
void plotBand(ImDrawList& draw, const PlotArea& area, const ForceHistory& history) {
  const auto& samples = history.samples();
  // Draw without antialiasing: soft edges would cost as much time as the curves.
  const ImDrawListFlags flags = draw.Flags;
  draw.Flags &= ~ImDrawListFlags_AntiAliasedFill;
  for (std::size_t n = 1; n < samples.size(); ++n) {
    const auto &a = samples[n - 1], &b = samples[n];
    if (!(a.bound > 0 || b.bound > 0) || std::isnan(a.bound) || std::isnan(b.bound)) continue;
    const float from = a.force.norm(), to = b.force.norm();
    draw.AddQuadFilled(area.at(a.time, from + a.bound), area.at(b.time, to + b.bound),
                       area.at(b.time, std::max(0.0F, to - b.bound)),
                       area.at(a.time, std::max(0.0F, from - a.bound)), band_colour);
  }
  draw.Flags = flags;
}

void plotCurves(ImDrawList& draw, const PlotArea& area, const ForceHistory& history) {
  // Draw one point per slot; more points would cost time and could not be seen.
  const double slot_length = ForceHistory::span * closest_points / (area.to.x - area.from.x);  // s
  std::vector<ImVec2> points;
  points.reserve(history.samples().size());
  for (std::size_t curve = 0; curve < curve_colours.size(); ++curve) {
    points.clear();
    double last = -1;
    for (const auto& [time, force, bound] : history.samples()) {
      // Choose the samples by time, not by screen position, so that consecutive frames show the
      // same samples.
      const double slot = std::floor(time / slot_length);
      if (slot == last && time != area.end) continue;
      last = slot;
      points.push_back(
          area.at(time, curve < 3 ? force[static_cast<Eigen::Index>(curve)] : force.norm()));
    }
    // Round the width: ImGui draws lines of integer width with few triangles.
    draw.AddPolyline(points.data(), static_cast<int>(points.size()), curve_colours[curve],
                     ImDrawFlags_None, std::round(px(curve == 3 ? 2.0F : 1.0F)));
  }
}

/// Draws above the curves as many entries of the legend as fit.
void plotLegend(ImDrawList& draw, ImVec2 at, float right) {
  const float middle = at.y + ImGui::GetTextLineHeight() / 2, key = px(key_length);
  const auto entry = [&](float indent, const char* text) {
    const float begin = at.x + indent, end = begin + ImGui::CalcTextSize(text).x;
    if (end > right) return false;
    draw.AddText({begin, at.y}, ink, text);
    at.x = end + px(legend_gap);
    return true;
  };
  float width = ImGui::CalcTextSize(plot_title).x;  // of the title and all entries
  for (const char* const name : legend_names)
    width += px(legend_gap + key_length + key_gap) + ImGui::CalcTextSize(name).x;
  entry(0, at.x + width > right ? short_plot_title : plot_title);
  for (std::size_t n = 0; n < legend_names.size(); ++n) {
    const ImVec2 from = at;
    if (!entry(key + px(key_gap), legend_names[n])) continue;
    if (n < curve_colours.size())
      draw.AddLine({from.x, middle}, {from.x + key, middle}, curve_colours[n], px(2));
    else
      draw.AddRectFilled({from.x, middle - px(band_height) / 2},
                         {from.x + key, middle + px(band_height) / 2}, band_colour);
  }
}

}  // namespace

void buildForcePlot(const ForceHistory& history, const Viewport& view) {
  const auto width = static_cast<float>(view.width);
  const auto height = static_cast<float>(view.window_height - view.height);
  ImGui::SetNextWindowPos({0, static_cast<float>(view.height)});
  ImGui::SetNextWindowSize({width, height});
  ImGui::Begin("##plot", nullptr, fixed_panel | ImGuiWindowFlags_NoScrollbar);
  const ImVec2 corner = ImGui::GetWindowPos();
  PlotArea area{{corner.x + px(margin_left), corner.y + px(margin_top)},
                {corner.x + width - px(margin_right), corner.y + height - px(margin_bottom)}};
  area.end = history.samples().empty() ? 0 : history.samples().back().time;
  area.limit = std::max(headroom * history.largest(), smallest_limit);
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  plotLegend(draw, {corner.x + px(legend_left), corner.y + px(legend_top)}, corner.x + width);
  plotGrid(draw, area);
  draw.PushClipRect(area.from, {area.to.x + 1, area.to.y}, true);
  plotBand(draw, area, history);
  plotCurves(draw, area, history);
  draw.PopClipRect();
  ImGui::End();
}

}  // namespace palpate
