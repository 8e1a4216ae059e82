#pragma once

#include <Inventor/SoDB.h>

namespace palpate {

/// Coin's types must be there before its first node is made; every part of the scene graph begins
/// with this.
inline void startCoin() {
  if (!SoDB::isInitialized()) SoDB::init();
}

}  // namespace palpate
