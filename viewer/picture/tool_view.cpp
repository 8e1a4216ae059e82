#include "viewer/picture/tool_view.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/assertion.hpp"
#include "viewer/picture/open_gl.hpp"

namespace palpate {
namespace {

using Paint = std::array<float, 4>;  // the last: how much it shines
constexpr Paint steel = {0.80F, 0.83F, 0.86F, 1}, grip = {0.50F, 0.56F, 0.62F, 0.9F},
                glove = {0.66F, 0.71F, 0.76F, 0.6F};
constexpr Paint sure = {0.10F, 0.42F, 0.86F, 0.5F}, unsure = {0.98F, 0.67F, 0.10F, 0.4F};
constexpr Paint at_rest = {0.16F, 0.26F, 0.48F, 0.9F};

// Of the extent.
constexpr double point_radius = 0.022, shortest_arrow = 0.015;
constexpr double arrow_radius = 0.011, head_radius = 0.030, head_length = 0.085, dash = 0.05;
constexpr double anchor_radius = 0.010, handle_length = 0.75, handle_radius = 0.014;
// Of the radius of the tool.
constexpr double disc_height = 0.22, finger_length = 2.2;
constexpr double hidden_opacity = 0.30, see_through_opacity = 0.35;

void paint(const Paint& colour) { glColor4fv(colour.data()); }

void dashedLine(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double dash_length) {
  const double length = (to - from).norm();
  const int pieces = std::clamp(static_cast<int>(length / dash_length), 1, 60);
  glBegin(GL_LINES);
  for (int n = 0; n < pieces; ++n)
    for (const double end : {0.0, 0.55}) {
      const Eigen::Vector3d at = from + (n + end) / pieces * (to - from);
      glVertex3dv(at.data());
    }
  glEnd();
}

}  // namespace

ToolView::ToolView(double extent, const SoftLight& light) : extent_(extent), light_(light) {
  PALPATE_ASSERT(extent > 0, "what has no size of its own is drawn by that of the scene");
}

void ToolView::setArrow(const Eigen::Vector3d& arrow, bool uncertain) {
  // NaN: no arrow either.
  arrow_ = arrow.allFinite() ? arrow : Eigen::Vector3d::Zero();
  uncertain_ = uncertain;
}

void ToolView::setAnchor(const Eigen::Vector3d& anchor, bool touching) {
  touching_ = touching && anchor.allFinite();
  anchor_ = anchor;
}

void ToolView::setSkin(const SkinBelow& skin, bool free) {
  free_ = free && skin.place.allFinite();
  skin_ = skin;
}

double ToolView::radius() const {
  return shape_.form == ToolForm::point ? point_radius * extent_ : shape_.radius;
}

double ToolView::handleRadius() const {
  return shape_.form == ToolForm::finger ? shape_.radius : handle_radius * extent_;
}

std::array<Eigen::Vector3d, 2> ToolView::axis() const {
  const Eigen::Vector3d middle =
      shape_.form == ToolForm::disc ? pose_.tip : pose_.tip + radius() * pose_.outward;
  const double length =
      shape_.form == ToolForm::finger ? finger_length * radius() : handle_length * extent_;
  return {middle, middle + length * pose_.handle};
}

void ToolView::draw() const {
  if (!pose_.tip.allFinite()) return;
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  glFrontFace(GL_CCW);
  glEnable(GL_LINE_SMOOTH);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  if (see_through_) {
    drawTranslucent(see_through_opacity);
  } else {
    glDepthFunc(GL_GREATER);
    drawTranslucent(hidden_opacity);
    glDepthFunc(GL_LEQUAL);
    drawTool(1);
  }
  if (free_) drawSkinLine();
  if (touching_) drawAnchor();
  if (arrow_.norm() > shortest_arrow * extent_) drawArrow();
}

void ToolView::drawTool(double opacity) const {
  light_.on(opacity, {});
  const std::array<Eigen::Vector3d, 2> ends = axis();
  const double length = (ends[1] - ends[0]).norm(), r = radius();
  switch (shape_.form) {
    case ToolForm::point:
      paint(steel);
      ball_.draw(ends[0], pose_.outward, r, r);
      paint(grip);
      handle_.draw(ends[0], pose_.handle, handleRadius(), length);
      break;
    case ToolForm::disc:
      paint(steel);
      disc_.draw(pose_.tip, pose_.outward, r, disc_height * r);
      paint(grip);
      handle_.draw(pose_.tip + 0.5 * disc_height * r * pose_.outward, pose_.handle, handleRadius(),
                   length);
      break;
    case ToolForm::finger:
      paint(glove);
      finger_.draw(ends[0], pose_.handle, r, r);
      break;
  }
  SoftLight::off();
}

void ToolView::drawTranslucent(double opacity) const {
  glDepthMask(GL_FALSE);
  glEnable(GL_BLEND);
  drawTool(opacity);
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
}

void ToolView::drawArrow() const {
  // Nothing hides the force, not the tool either.
  glDepthRange(0, 0.01);
  light_.on(1, {});
  paint(uncertain_ ? unsure : sure);
  const double length = arrow_.norm();
  const Eigen::Vector3d along = arrow_ / length;
  const double head = std::min(head_length * extent_, 0.6 * length), shaft = length - head;
  const double share = head / (head_length * extent_), wide = share * arrow_radius * extent_;
  const int pieces = uncertain_ ? std::max(2, static_cast<int>(shaft / (dash * extent_))) : 1;
  const double filled = uncertain_ ? 0.6 : 1;
  for (int n = 0; n < pieces; ++n)
    cylinder_.draw(pose_.tip + shaft * n / pieces * along, along, wide, filled * shaft / pieces);
  cone_.draw(pose_.tip + shaft * along, along, share * head_radius * extent_, head);
  SoftLight::off();
  glDepthRange(0, 1);
}

void ToolView::drawAnchor() const {
  glEnable(GL_BLEND);
  setLineWidth(1.5F);
  paint(at_rest);
  glBegin(GL_LINES);
  glVertex3dv(anchor_.data());
  glVertex3dv(pose_.tip.data());
  glEnd();
  glDisable(GL_BLEND);
  light_.on(1, {});
  paint(at_rest);
  ball_.draw(anchor_, Eigen::Vector3d::UnitZ(), anchor_radius * extent_, anchor_radius * extent_);
  SoftLight::off();
}

void ToolView::drawSkinLine() const {
  glEnable(GL_BLEND);
  setLineWidth(1.5F);
  paint(at_rest);
  dashedLine(pose_.tip, skin_.place, 0.04 * extent_);
  glDisable(GL_BLEND);
}

}  // namespace palpate
