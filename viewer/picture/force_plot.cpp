#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "viewer/picture/panel_style.hpp"
#include "viewer/picture/panels.hpp"
#include "viewer/plot/round_numbers.hpp"

namespace palpate {
namespace {

// px: the curves within the panel, and its texts.
constexpr float margin_left = 52, margin_right = 28, margin_top = 30, margin_bottom = 24;
constexpr float legend_left = 14, legend_top = 9, title_width = 168, legend_step = 52;
constexpr float key_length = 16, key_gap = 5;
constexpr float label_gap = 8, time_gap = 3, half_line = 7;

constexpr double headroom = 1.08;       // above the largest force
constexpr double smallest_limit = 0.5;  // N: below it the plot does not grow
constexpr int most_steps = 2;           // of the grid, up and down from zero
constexpr std::array<ImU32, 4> curve_colours = {
    IM_COL32(214, 94, 0, 255), IM_COL32(0, 140, 100, 255), IM_COL32(0, 104, 190, 255),
    IM_COL32(30, 30, 36, 255)};
constexpr std::array<const char*, 4> curve_names = {"x", "y", "z", "|F|"};

/// Where the curves of the plot go on the screen.
struct PlotArea {
  ImVec2 from, to;
  double end = 0;    ///< s, at the right edge
  double limit = 1;  ///< N, at the upper edge; minus that at the lower one
  ImVec2 at(double time, double force) const {
    const double across = 1 - (end - time) / ForceHistory::span, up = 0.5 * (1 + force / limit);
    return {static_cast<float>(std::lerp(from.x, to.x, across)),
            static_cast<float>(std::lerp(to.y, from.y, up))};
  }
};

void plotGrid(ImDrawList& draw, const PlotArea& area) {
  const double step = roundUp(area.limit / most_steps);
  const int steps = static_cast<int>(area.limit / step * 1.001);
  for (int n = -steps; n <= steps; ++n) {
    const float y = area.at(area.end, n * step).y;
    draw.AddLine({area.from.x, y}, {area.to.x, y}, line_grey);
    const std::string text = fmt::format("{:g}", n * step);
    draw.AddText({area.from.x - label_gap - ImGui::CalcTextSize(text.c_str()).x, y - half_line},
                 faint, text.c_str());
  }
  for (int second = 0; second <= static_cast<int>(ForceHistory::span); ++second) {
    const float x = area.at(area.end - second, 0).x;
    draw.AddLine({x, area.from.y}, {x, area.to.y}, line_grey);
    const std::string text = second == 0 ? "now" : fmt::format("-{} s", second);
    draw.AddText({x - ImGui::CalcTextSize(text.c_str()).x / 2, area.to.y + time_gap}, faint,
                 text.c_str());
  }
}

void plotCurves(ImDrawList& draw, const PlotArea& area, const ForceHistory& history) {
  std::vector<ImVec2> points;
  points.reserve(history.samples().size());
  for (std::size_t curve = 0; curve < curve_colours.size(); ++curve) {
    points.clear();
    for (const auto& [time, force] : history.samples())
      points.push_back(
          area.at(time, curve < 3 ? force[static_cast<Eigen::Index>(curve)] : force.norm()));
    // Whole widths: ImGui draws those with few triangles.
    draw.AddPolyline(points.data(), static_cast<int>(points.size()), curve_colours[curve],
                     ImDrawFlags_None, curve == 3 ? 2.0F : 1.0F);
  }
}

void plotLegend(ImDrawList& draw, ImVec2 at) {
  draw.AddText(at, ink, "force on the tool, N");
  at.x += title_width;
  for (std::size_t curve = 0; curve < curve_colours.size(); ++curve) {
    draw.AddLine({at.x, at.y + half_line}, {at.x + key_length, at.y + half_line},
                 curve_colours[curve], 2);
    draw.AddText({at.x + key_length + key_gap, at.y}, ink, curve_names[curve]);
    at.x += legend_step;
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
  PlotArea area{{corner.x + margin_left, corner.y + margin_top},
                {corner.x + width - margin_right, corner.y + height - margin_bottom}};
  area.end = history.samples().empty() ? 0 : history.samples().back().time;
  area.limit = std::max(headroom * history.largest(), smallest_limit);
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  plotLegend(draw, {corner.x + legend_left, corner.y + legend_top});
  plotGrid(draw, area);
  draw.PushClipRect(area.from, {area.to.x + 1, area.to.y}, true);
  plotCurves(draw, area, history);
  draw.PopClipRect();
  ImGui::End();
}

}  // namespace palpate
