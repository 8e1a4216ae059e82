#pragma once

#include <utility>

#include "tests/system/browser.hpp"

namespace palpate::test {

/// A pixel of the canvas on a page of `palpate share` at which the organ can be touched, if
/// possible with touchable neighbours. Searches a grid. Throws if there is none.
inline std::pair<double, double> touchablePixel(Browser& browser) {
  const nlohmann::json place = browser.valueOf(
      "(() => {"
      "  const touchable = (x, y) => (palpate.page.hit(x, y) || {touch: -1}).touch >= 0;"
      "  for (const around of [[[-20, 0], [40, 20]], []])"
      "    for (let y = 100; y < innerHeight - 100; y += 10)"
      "      for (let x = 30; x < innerWidth - 30; x += 10)"
      "        if (document.elementFromPoint(x, y).id === 'organ' && touchable(x, y) &&"
      "            around.every(([dx, dy]) => touchable(x + dx, y + dy))) return [x, y];"
      "  return null})()");
  if (!place.is_array()) throw failure("nothing of the organ can be touched");
  return {place.at(0), place.at(1)};
}

}  // namespace palpate::test
