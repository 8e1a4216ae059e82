#include "viewer/picture/tool_view.hpp"

#include <algorithm>

#include "viewer/picture/open_gl.hpp"

namespace palpate {
namespace {

using Paint = std::array<float, 4>;  // red, green, blue, shine
constexpr Paint steel = {0.80F, 0.83F, 0.86F, 1}, grip = {0.50F, 0.56F, 0.62F, 0.9F},
                glove = {0.66F, 0.71F, 0.76F, 0.6F}, other_glove = {0.52F, 0.68F, 0.58F, 0.6F};
constexpr Paint sure = {0.10F, 0.42F, 0.86F, 0.5F}, unsure = {0.98F, 0.67F, 0.10F, 0.4F};
constexpr Paint at_rest = {0.16F, 0.26F, 0.48F, 0.9F};

// Sizes as fractions of the scene's extent.
constexpr double point_radius = 0.022, shortest_arrow = 0.015;
constexpr double arrow_radius = 0.011, head_radius = 0.030, head_length = 0.085, dash = 0.05,
                 skin_dash = 0.04;
constexpr double anchor_radius = 0.010, handle_length = 0.75, handle_radius = 0.014;
// Sizes in radii of the tool.
constexpr double disc_height = 0.22, finger_length = 2.2;
constexpr double hidden_opacity = 0.30, see_through_opacity = 0.35;

void paint(const Paint& colour) { glColor4fv(colour.data()); }

/// Draws a thin dashed line. filled: fraction of each piece that is drawn.
void drawThread(const Eigen::Vector3d& from, const Eigen::Vector3d& to, int pieces, double filled) {
  glEnable(GL_BLEND);
  setLineWidth(1.5F);
  paint(at_rest);
  glBegin(GL_LINES);
  for (int n = 0; n < pieces; ++n)
    for (const double end : {0.0, filled}) {
      const Eigen::Vector3d at = from + (n + end) / pieces * (to - from);
      glVertex3dv(at.data());
    }
  glEnd();
  glDisable(GL_BLEND);
}

}  // namespace

ToolShape toolOf(const HapticModel& model, std::size_t space) {
  const double radius = model.toolRadius(space);
  if (model.spaces()[space].patch.finger) return {ToolForm::finger, radius};
  return radius > 0 ? ToolShape{ToolForm::disc, radius} : ToolShape{};
}

double ShownTool::radius() const {
  return shape.form == ToolForm::point ? point_radius * extent : shape.radius;
}

double ShownTool::handleRadius() const {
  return shape.form == ToolForm::finger ? shape.radius : handle_radius * extent;
}

std::array<Eigen::Vector3d, 2> ShownTool::axis() const {
  const Eigen::Vector3d middle =
      shape.form == ToolForm::disc ? pose.tip : pose.tip + radius() * pose.outward;
  const double length =
      shape.form == ToolForm::finger ? finger_length * radius() : handle_length * extent;
  return {middle, middle + length * pose.handle};
}

void ToolView::draw(const ShownTool& tool, const SoftLight& light) const {
  if (!tool.pose.tip.allFinite()) return;
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  glFrontFace(GL_CCW);
  glEnable(GL_LINE_SMOOTH);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  if (tool.see_through) {
    drawTranslucent(tool, light, see_through_opacity);
  } else {
    glDepthFunc(GL_GREATER);
    drawTranslucent(tool, light, hidden_opacity);
    glDepthFunc(GL_LEQUAL);
    drawTool(tool, light, 1);
  }
  if (tool.skin) drawSkinLine(tool);
  if (tool.anchor) drawAnchor(tool, light);
  if (tool.arrow.norm() > shortest_arrow * tool.extent) drawArrow(tool, light);
}

void ToolView::drawTool(const ShownTool& tool, const SoftLight& light, double opacity) const {
  light.on(opacity, {});
  const ToolPose& pose = tool.pose;
  const std::array<Eigen::Vector3d, 2> ends = tool.axis();
  const double length = (ends[1] - ends[0]).norm(), r = tool.radius();
  switch (tool.shape.form) {
    case ToolForm::point:
      paint(steel);
      ball_.draw(ends[0], pose.outward, r, r);
      paint(grip);
      handle_.draw(ends[0], pose.handle, tool.handleRadius(), length);
      break;
    case ToolForm::disc:
      paint(steel);
      disc_.draw(pose.tip, pose.outward, r, disc_height * r);
      paint(grip);
      handle_.draw(pose.tip + 0.5 * disc_height * r * pose.outward, pose.handle,
                   tool.handleRadius(), length);
      break;
    case ToolForm::finger:
      paint(tool.holds ? other_glove : glove);
      finger_.draw(ends[0], pose.handle, r, r);
      break;
  }
  SoftLight::off();
}

void ToolView::drawTranslucent(const ShownTool& tool, const SoftLight& light,
                               double opacity) const {
  glDepthMask(GL_FALSE);
  glEnable(GL_BLEND);
  drawTool(tool, light, opacity);
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
}

void ToolView::drawArrow(const ShownTool& tool, const SoftLight& light) const {
  // Draw in front of everything, including the tool.
  glDepthRange(0, 0.01);
  light.on(1, {});
  paint(tool.uncertain ? unsure : sure);
  const double length = tool.arrow.norm();
  const Eigen::Vector3d along = tool.arrow / length;
  const double longest_head = head_length * tool.extent,
               head = std::min(longest_head, 0.6 * length), shaft = length - head;
  const double share = head / longest_head, wide = share * arrow_radius * tool.extent;
  const int dashes = std::max(2, static_cast<int>(shaft / (dash * tool.extent)));
  const int pieces = tool.uncertain ? dashes : 1;
  const double filled = tool.uncertain ? 0.6 : 1;
  const Eigen::Vector3d& tip = tool.pose.tip;
  for (int n = 0; n < pieces; ++n)
    cylinder_.draw(tip + shaft * n / pieces * along, along, wide, filled * shaft / pieces);
  cone_.draw(tip + shaft * along, along, share * head_radius * tool.extent, head);
  SoftLight::off();
  glDepthRange(0, 1);
}

void ToolView::drawAnchor(const ShownTool& tool, const SoftLight& light) const {
  drawThread(*tool.anchor, tool.pose.tip, 1, 1);
  light.on(1, {});
  paint(at_rest);
  const double radius = anchor_radius * tool.extent;
  ball_.draw(*tool.anchor, Eigen::Vector3d::UnitZ(), radius, radius);
  SoftLight::off();
}

void ToolView::drawSkinLine(const ShownTool& tool) {
  const double length = (*tool.skin - tool.pose.tip).norm();
  const int pieces = std::clamp(static_cast<int>(length / (skin_dash * tool.extent)), 1, 60);
  drawThread(tool.pose.tip, *tool.skin, pieces, 0.55);
}

}  // namespace palpate
