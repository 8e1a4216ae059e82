#pragma once

#include <utility>

#include "tests/system/browser.hpp"

namespace palpate::test {

/// Of the canvas of a page of `palpate share`: a place where the organ can be touched, and so it
/// can around it. A grid is tried. Error when there is none.
inline std::pair<double, double> touchablePixel(Browser& browser) {
  const nlohmann::json place = browser.valueOf(
      "(() => {for (let y = 200; y < 520; y += 20) for (let x = 300; x < 900; x += 20) {"
      "  const hit = palpate.page.hit(x, y);"
      "  if (hit && hit.touch >= 0 && [[-20, 0], [40, 20]].every(([dx, dy]) => {"
      "    const other = palpate.page.hit(x + dx, y + dy); return other && other.touch >= 0})) "
      "return [x, y];} return null})()");
  if (!place.is_array()) throw failure("nothing of the organ can be touched");
  return {place.at(0), place.at(1)};
}

}  // namespace palpate::test
