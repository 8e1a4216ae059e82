#include "viewer/picture/lattice_view.hpp"

#include <GL/gl.h>
#include <Inventor/actions/SoGLRenderAction.h>
#include <Inventor/nodes/SoCallback.h>
#include <Inventor/nodes/SoDrawStyle.h>
#include <Inventor/nodes/SoLightModel.h>
#include <Inventor/nodes/SoPointSet.h>
#include <Inventor/nodes/SoSeparator.h>
#include <Inventor/nodes/SoSwitch.h>
#include <Inventor/nodes/SoVertexProperty.h>

#include <cmath>
#include <vector>

namespace palpate {
namespace {

void clearDepth(void* /*nothing*/, SoAction* action) {
  if (action->isOfType(SoGLRenderAction::getClassTypeId())) glClear(GL_DEPTH_BUFFER_BIT);
}

/// As SoVertexProperty has it: red in the highest byte.
std::uint32_t packed(const std::array<double, 3>& colour) {
  std::uint32_t bits = 0;
  for (const double channel : colour) bits = bits << 8 | static_cast<std::uint32_t>(std::lround(channel));
  return bits << 8 | 255U;
}

}  // namespace

LatticeView::LatticeView() : node_(new SoSwitch), dots_(new SoVertexProperty), style_(new SoDrawStyle) {
  node_->ref();
  auto* group = new SoSeparator;
  auto* front = new SoCallback;
  front->setCallback(clearDepth);
  auto* unlit = new SoLightModel;
  unlit->model.setValue(SoLightModel::BASE_COLOR);
  auto* points = new SoPointSet;
  dots_->materialBinding.setValue(SoVertexProperty::PER_VERTEX);
  points->vertexProperty.setValue(dots_);
  group->addChild(front);
  group->addChild(unlit);
  group->addChild(style_);
  group->addChild(points);
  node_->addChild(group);
  show(false);
}

LatticeView::~LatticeView() {
  node_->unref();
}

void LatticeView::setDots(std::span<const LatticeDot> dots, const Eigen::Vector3d& origin, double size) {
  std::vector<SbVec3f> places;
  std::vector<std::uint32_t> colours;
  for (const LatticeDot& dot : dots) {
    const Eigen::Vector3f place = (origin + dot.displacement).cast<float>();
    places.emplace_back(place.x(), place.y(), place.z());
    colours.push_back(packed(dot.colour));
  }
  const int count = static_cast<int>(dots.size());
  dots_->vertex.setNum(count);
  dots_->orderedRGBA.setNum(count);
  dots_->vertex.setValues(0, count, places.data());
  dots_->orderedRGBA.setValues(0, count, colours.data());
  style_->pointSize.setValue(static_cast<float>(size));
}

void LatticeView::show(bool shown) {
  const int child = shown ? SO_SWITCH_ALL : SO_SWITCH_NONE;
  if (node_->whichChild.getValue() != child) node_->whichChild.setValue(child);
}

}  // namespace palpate
