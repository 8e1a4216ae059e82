#pragma once

#include <Inventor/SbVec3f.h>
#include <Inventor/SoDB.h>
#include <Inventor/nodes/SoSeparator.h>
#include <Inventor/nodes/SoSwitch.h>

#include <Eigen/Core>
#include <initializer_list>

namespace palpate {

/// Coin's types must be there before its first node is made; every part of the scene graph begins
/// with this.
inline void startCoin() {
  if (!SoDB::isInitialized()) SoDB::init();
}

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
