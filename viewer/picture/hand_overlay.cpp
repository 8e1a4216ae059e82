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
constexpr float ring_width = 2.5F, ring_edge_width = 4.5F, cursor_ring = 13,
                cursor_line_width = 1.5F;
constexpr ImU32 cursor_fill = IM_COL32(255, 255, 255, 255), cursor_line = IM_COL32(20, 22, 28, 255);

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

/// The arrow of a mouse, with a spot under it while its button is held.
void drawCursor(ImDrawList& draw, ImVec2 tip, bool pressed) {
  if (pressed) draw.AddCircle(tip, px(cursor_ring), ring_colour, 0, px(ring_width));
  const auto corner = [tip](float x, float y) { return ImVec2{tip.x + px(x), tip.y + px(y)}; };
  const std::array outline = {corner(0, 0),   corner(0, 21), corner(5, 16.5F), corner(8.5F, 24),
                              corner(12, 22), corner(9, 15), corner(15, 15)};
  // ImGui fills convex shapes alone: the head, and the stem below it.
  draw.AddTriangleFilled(outline[0], outline[1], outline[6], cursor_fill);
  draw.AddQuadFilled(outline[2], outline[3], outline[4], outline[5], cursor_fill);
  draw.AddPolyline(outline.data(), static_cast<int>(outline.size()), cursor_line,
                   ImDrawFlags_Closed, px(cursor_line_width));
}

}  // namespace

void drawHandMarks(const HandMarks& marks, const OrbitCamera& camera, const Viewport& view) {
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  draw.PushClipRect({0, 0}, {static_cast<float>(view.width), static_cast<float>(view.height)});
  if (marks.ring) drawRing(draw, marks, camera, view);
  if (marks.cursor) drawCursor(draw, onScreen(*marks.cursor, view), marks.button);
  draw.PopClipRect();
}

}  // namespace palpate
