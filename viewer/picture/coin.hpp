#pragma once

#include <Inventor/SbVec3f.h>
#include <Inventor/SoDB.h>
#include <Inventor/actions/SoGLRenderAction.h>
#include <Inventor/nodes/SoCallback.h>
#include <Inventor/nodes/SoSeparator.h>
#include <Inventor/nodes/SoSwitch.h>

#include <Eigen/Core>
#include <functional>
#include <initializer_list>
#include <utility>

#include "viewer/picture/open_gl.hpp"

namespace palpate {

/// Coin's types must be there before its first node is made; every part of the scene graph begins
/// with this.
inline void startCoin() {
  if (!SoDB::isInitialized()) SoDB::init();
}

/// A node that OpenGL draws by a function of ours, which begins without lighting and textures; Coin
/// finds its state as it left it. A node that outlives this object draws nothing.
class Drawing {
 public:
  explicit Drawing(std::function<void()> draw)
      : draw_(std::move(draw)), node_((startCoin(), new SoCallback)) {
    node_->ref();
    node_->setCallback(render, this);
  }
  ~Drawing() {
    node_->setCallback(nullptr);
    node_->unref();
  }
  Drawing(const Drawing&) = delete;
  Drawing& operator=(const Drawing&) = delete;

  SoCallback* node() const { return node_; }

 private:
  static void render(void* drawing, SoAction* action) {
    if (!action->isOfType(SoGLRenderAction::getClassTypeId())) return;
    glPushAttrib(GL_ALL_ATTRIB_BITS);
    glPushClientAttrib(GL_CLIENT_VERTEX_ARRAY_BIT);
    glDisable(GL_LIGHTING);
    glDisable(GL_TEXTURE_2D);
    static_cast<const Drawing*>(drawing)->draw_();
    glPopClientAttrib();
    glPopAttrib();
  }

  std::function<void()> draw_;
  SoCallback* node_;
};

/// A vector as Coin takes it, in float32.
inline SbVec3f coin(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

/// A separator of these nodes, in order.
inline SoSeparator* group(std::initializer_list<SoNode*> nodes) {
  auto* made = new SoSeparator;
  for (SoNode* node : nodes) made->addChild(node);
  return made;
}

/// Shows all or nothing of what is below a switch. One that stands right is not touched: Coin would
/// count it as a change of the scene.
inline void show(SoSwitch* which, bool shown) {
  const int child = shown ? SO_SWITCH_ALL : SO_SWITCH_NONE;
  if (which->whichChild.getValue() != child) which->whichChild.setValue(child);
}

}  // namespace palpate
