#include "viewer/picture/lattice_view.hpp"

#include <GL/gl.h>
#include <Inventor/actions/SoGLRenderAction.h>
#include <Inventor/nodes/SoCallback.h>

#include <cmath>

#include "viewer/picture/coin.hpp"

namespace palpate {

LatticeView::LatticeView() : node_((startCoin(), new SoSwitch)), dots_(new SoCallback) {
  node_->ref();
  dots_->setCallback(render, this);
  node_->addChild(dots_);
  show(false);
}

LatticeView::~LatticeView() {
  dots_->setCallback(nullptr);
  node_->unref();
}

void LatticeView::setDots(std::span<const LatticeDot> dots, const Eigen::Vector3d& origin,
                          double size) {
  places_.clear();
  colours_.clear();
  for (const LatticeDot& dot : dots) {
    const Eigen::Vector3f place = (origin + dot.displacement).cast<float>();
    places_.insert(places_.end(), place.begin(), place.end());
    for (const double channel : dot.colour)
      colours_.push_back(static_cast<std::uint8_t>(std::lround(channel)));
  }
  size_ = static_cast<float>(size);
}

void LatticeView::show(bool shown) { palpate::show(node_, shown); }

void LatticeView::render(void* view, SoAction* action) {
  if (!action->isOfType(SoGLRenderAction::getClassTypeId())) return;
  const auto& self = *static_cast<const LatticeView*>(view);
  glPushAttrib(GL_ENABLE_BIT | GL_POINT_BIT | GL_CURRENT_BIT);
  glPushClientAttrib(GL_CLIENT_VERTEX_ARRAY_BIT);
  glClear(GL_DEPTH_BUFFER_BIT);
  glDisable(GL_LIGHTING);
  glDisable(GL_TEXTURE_2D);
  glEnable(GL_DEPTH_TEST);
  glPointSize(self.size_);
  glEnableClientState(GL_VERTEX_ARRAY);
  glEnableClientState(GL_COLOR_ARRAY);
  glVertexPointer(3, GL_FLOAT, 0, self.places_.data());
  glColorPointer(3, GL_UNSIGNED_BYTE, 0, self.colours_.data());
  glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(self.places_.size() / 3));
  glPopClientAttrib();
  glPopAttrib();
}

}  // namespace palpate
