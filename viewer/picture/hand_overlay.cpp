#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "viewer/picture/panel_style.hpp"
#include "viewer/picture/panels.hpp"

namespace palpate {
namespace {

constexpr ImU32 ring_colour = IM_COL32(255, 196, 92, 255), ring_edge = IM_COL32(60, 36, 8, 150);
constexpr int ring_corners = 40;
constexpr double above_skin = 0.06;  // of its radius, for which no triangle hides it
// px
constexpr float ring_width = 2.5F, ring_edge_width = 4.5F;

ImVec2 onScreen(const Eigen::Vector2d& place, const Viewport& view) {
  const auto height = static_cast<float>(view.height);
  return {static_cast<float>(view.width) / 2 + height * static_cast<float>(place.x()),
          height / 2 - height * static_cast<float>(place.y())};
}

/// A circle about the place in the plane of the skin.
void drawRing(ImDrawList& draw, const HandMarks& marks, const OrbitCamera& camera,
              const Viewport& view) {
  const Eigen::Vector3d across = marks.ring->normal.unitOrthogonal(),
                        along = marks.ring->normal.cross(across);
  const Eigen::Vector3d middle =
      marks.ring->position + above_skin * marks.ring_radius * marks.ring->normal;
  std::array<ImVec2, ring_corners> corners;
  for (int n = 0; n < ring_corners; ++n) {
    const double angle = 2 * std::numbers::pi * n / ring_corners;
    const Eigen::Vector3d seen = camera.project(
        middle + marks.ring_radius * (std::cos(angle) * across + std::sin(angle) * along));
    if (!(seen.z() > 0)) return;
    corners[static_cast<std::size_t>(n)] = onScreen(seen.head<2>(), view);
  }
  draw.AddPolyline(corners.data(), ring_corners, ring_edge, ImDrawFlags_Closed,
                   px(ring_edge_width));
  draw.AddPolyline(corners.data(), ring_corners, ring_colour, ImDrawFlags_Closed, px(ring_width));
}

}  // namespace

void drawHandMarks(const HandMarks& marks, const OrbitCamera& camera, const Viewport& view) {
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  draw.PushClipRect({0, 0}, {static_cast<float>(view.width), static_cast<float>(view.height)});
  if (marks.ring) drawRing(draw, marks, camera, view);
  draw.PopClipRect();
}

}  // namespace palpate
