#include "viewer/picture/scale_and_axes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "viewer/picture/panel_style.hpp"
#include "viewer/plot/round_numbers.hpp"

namespace palpate {
namespace {

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

void drawScaleAndAxes(ImDrawList& draw, const PanelContents& contents, ImVec2 size, float foot) {
  const ImVec2 corner = {size.x - px(corner_margin), foot - px(corner_margin)};
  drawAxes(draw, contents.camera, {corner.x - px(axes_room / 2), corner.y - px(axes_room / 2)});
  drawScale(draw, contents, size, {corner.x - px(axes_room + 2 * corner_margin), corner.y});
}

}  // namespace palpate
