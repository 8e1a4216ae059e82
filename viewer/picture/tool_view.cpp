#include "viewer/picture/tool_view.hpp"

#include <Inventor/nodes/SoComplexity.h>
#include <Inventor/nodes/SoCone.h>
#include <Inventor/nodes/SoCylinder.h>
#include <Inventor/nodes/SoMaterial.h>
#include <Inventor/nodes/SoSphere.h>
#include <Inventor/nodes/SoTransform.h>

#include <algorithm>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

// In radii of the sphere.
constexpr double shaft_radius = 0.34, head_radius = 0.85, head_length = 2.2, anchor_radius = 0.42;

SoMaterial* material(float red, float green, float blue) {
  auto* made = new SoMaterial;
  made->diffuseColor.setValue(red, green, blue);
  made->ambientColor.setValue(0.5F * red, 0.5F * green, 0.5F * blue);
  made->specularColor.setValue(0.35F, 0.35F, 0.35F);
  made->shininess.setValue(0.3F);
  return made;
}

SoSphere* sphere(double radius) {
  auto* made = new SoSphere;
  made->radius.setValue(static_cast<float>(radius));
  return made;
}

SoSwitch* switchOver(SoNode* content) {
  auto* made = new SoSwitch;
  made->addChild(content);
  made->whichChild.setValue(SO_SWITCH_NONE);
  return made;
}

}  // namespace

ToolView::ToolView(double radius)
    : radius_(radius),
      node_((startCoin(), new SoSeparator)),
      tool_place_(new SoTransform),
      arrow_place_(new SoTransform),
      shaft_place_(new SoTransform),
      head_place_(new SoTransform),
      anchor_place_(new SoTransform),
      thread_([this] { drawThread(); }) {
  PALPATE_ASSERT(radius > 0, "the tool is drawn by its size");
  node_->ref();
  auto* complexity = new SoComplexity;
  complexity->value.setValue(0.5F);
  node_->addChild(complexity);
  node_->addChild(tool_switch_ = switchOver(
                      group({material(0.95F, 0.95F, 0.97F), tool_place_, sphere(radius)})));
  auto* shaft = new SoCylinder;  // height 1 along y around the middle; scaled by its place
  shaft->radius.setValue(static_cast<float>(shaft_radius * radius));
  shaft->height.setValue(1);
  auto* head = new SoCone;
  head->bottomRadius.setValue(static_cast<float>(head_radius * radius));
  head->height.setValue(static_cast<float>(head_length * radius));
  node_->addChild(arrow_switch_ = switchOver(
                      group({material(0.86F, 0.20F, 0.13F), arrow_place_,
                             group({shaft_place_, shaft}), group({head_place_, head})})));
  node_->addChild(anchor_switch_ = switchOver(
                      group({thread_.node(), group({material(0.95F, 0.55F, 0.10F), anchor_place_,
                                                    sphere(anchor_radius * radius)})})));
}

ToolView::~ToolView() { node_->unref(); }

void ToolView::drawThread() const {
  glLineWidth(2);
  glColor3f(0.90F, 0.45F, 0.05F);
  glBegin(GL_LINES);
  glVertex3dv(anchor_.data());
  glVertex3dv(tool_.data());
  glEnd();
}

void ToolView::setTool(const Eigen::Vector3d& tool) {
  const bool finite = tool.allFinite();
  show(tool_switch_, finite);
  if (!finite) return;
  tool_ = tool;
  tool_place_->translation.setValue(coin(tool));
}

void ToolView::setArrow(const Eigen::Vector3d& arrow) {
  const double length = arrow.norm();
  const bool shown = length > radius_ && arrow.allFinite();  // NaN: no arrow either
  show(arrow_switch_, shown);
  if (!shown) return;
  arrow_place_->translation.setValue(coin(tool_));
  // Shaft and head of Coin lie along y.
  arrow_place_->rotation.setValue(SbRotation(SbVec3f(0, 1, 0), coin(arrow / length)));
  const double head = std::min(head_length * radius_, 0.6 * length);
  const double shaft = length - head, head_scale = head / (head_length * radius_);
  shaft_place_->translation.setValue(coin({0, shaft / 2, 0}));
  shaft_place_->scaleFactor.setValue(coin({1, shaft, 1}));
  head_place_->translation.setValue(coin({0, shaft + head / 2, 0}));
  head_place_->scaleFactor.setValue(coin(Eigen::Vector3d::Constant(head_scale)));
}

void ToolView::setAnchor(const Eigen::Vector3d& anchor, bool touching) {
  const bool shown = touching && anchor.allFinite();
  show(anchor_switch_, shown);
  if (!shown) return;
  anchor_place_->translation.setValue(coin(anchor));
  anchor_ = anchor;
}

}  // namespace palpate
