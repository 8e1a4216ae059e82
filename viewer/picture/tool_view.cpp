#include "viewer/picture/tool_view.hpp"

#include <GL/gl.h>
#include <Inventor/actions/SoGLRenderAction.h>
#include <Inventor/nodes/SoCallback.h>
#include <Inventor/nodes/SoComplexity.h>
#include <Inventor/nodes/SoCone.h>
#include <Inventor/nodes/SoCylinder.h>
#include <Inventor/nodes/SoMaterial.h>
#include <Inventor/nodes/SoSeparator.h>
#include <Inventor/nodes/SoSphere.h>
#include <Inventor/nodes/SoTransform.h>

#include <algorithm>

#include "viewer/picture/coin.hpp"

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

SoSwitch* switchOver(SoNode* content) {
  auto* made = new SoSwitch;
  made->addChild(content);
  made->whichChild.setValue(SO_SWITCH_NONE);
  return made;
}

}  // namespace

ToolView::ToolView(double radius) : radius_(radius), node_((startCoin(), new SoSeparator)) {
  node_->ref();
  auto* complexity = new SoComplexity;
  complexity->value.setValue(0.5F);
  node_->addChild(complexity);
  makeSphere();
  makeArrow();
  makeAnchor();
}

ToolView::~ToolView() {
  thread_->setCallback(nullptr);
  node_->unref();
}

void ToolView::makeSphere() {
  auto* group = new SoSeparator;
  tool_place_ = new SoTransform;
  auto* sphere = new SoSphere;
  sphere->radius.setValue(static_cast<float>(radius_));
  group->addChild(material(0.95F, 0.95F, 0.97F));
  group->addChild(tool_place_);
  group->addChild(sphere);
  node_->addChild(tool_switch_ = switchOver(group));
}

void ToolView::makeArrow() {
  auto* group = new SoSeparator;
  group->addChild(material(0.86F, 0.20F, 0.13F));
  group->addChild(arrow_place_ = new SoTransform);
  auto* shaft = new SoSeparator;
  shaft->addChild(shaft_place_ = new SoTransform);
  auto* cylinder = new SoCylinder;  // height 1 along y around the middle; scaled by its place
  cylinder->radius.setValue(static_cast<float>(shaft_radius * radius_));
  cylinder->height.setValue(1);
  shaft->addChild(cylinder);
  group->addChild(shaft);
  auto* head = new SoSeparator;
  head->addChild(head_place_ = new SoTransform);
  auto* cone = new SoCone;
  cone->bottomRadius.setValue(static_cast<float>(head_radius * radius_));
  cone->height.setValue(static_cast<float>(head_length * radius_));
  head->addChild(cone);
  group->addChild(head);
  node_->addChild(arrow_switch_ = switchOver(group));
}

void ToolView::makeAnchor() {
  auto* group = new SoSeparator;
  thread_ = new SoCallback;
  thread_->setCallback(drawThread, this);
  group->addChild(thread_);
  auto* point = new SoSeparator;
  point->addChild(material(0.95F, 0.55F, 0.10F));
  point->addChild(anchor_place_ = new SoTransform);
  auto* sphere = new SoSphere;
  sphere->radius.setValue(static_cast<float>(anchor_radius * radius_));
  point->addChild(sphere);
  group->addChild(point);
  node_->addChild(anchor_switch_ = switchOver(group));
}

void ToolView::drawThread(void* view, SoAction* action) {
  if (!action->isOfType(SoGLRenderAction::getClassTypeId())) return;
  const auto& self = *static_cast<const ToolView*>(view);
  glPushAttrib(GL_ENABLE_BIT | GL_LINE_BIT | GL_CURRENT_BIT);
  glDisable(GL_LIGHTING);
  glDisable(GL_TEXTURE_2D);
  glLineWidth(2);
  glColor3f(0.90F, 0.45F, 0.05F);
  glBegin(GL_LINES);
  glVertex3dv(self.anchor_.data());
  glVertex3dv(self.tool_.data());
  glEnd();
  glPopAttrib();
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
  arrow_place_->rotation.setValue(SbRotation(SbVec3f(0, 1, 0), coin(arrow / length)));
  const double head = std::min(head_length * radius_, 0.6 * length);
  const double shaft = length - head, head_scale = head / (head_length * radius_);
  shaft_place_->translation.setValue(coin({0, shaft / 2, 0}));
  shaft_place_->scaleFactor.setValue(coin({1, shaft, 1}));
  head_place_->translation.setValue(coin({0, shaft + head / 2, 0}));
  head_place_->scaleFactor.setValue(coin(Eigen::Vector3d::Constant(head_scale)));
}

void ToolView::showAnchor(const Eigen::Vector3d& anchor) {
  show(anchor_switch_, anchor.allFinite());
  if (!anchor.allFinite()) return;
  anchor_place_->translation.setValue(coin(anchor));
  anchor_ = anchor;
}

void ToolView::hideAnchor() { show(anchor_switch_, false); }

}  // namespace palpate
