#include <algorithm>

#include "tests/fuzz/fuzzer.hpp"
#include "tests/support/small_organ.hpp"
#include "viewer/organ/touched_organ.hpp"

namespace palpate::fuzz {
namespace {

/// Limit on the steps of preparation for each place, because a step takes several milliseconds.
constexpr int most_pieces = 40;

/// Touches the middles of triangles, with the calls that a page makes.
void touchAll(TouchedOrgan& touched) {
  const CarriedOrgan& organ = touched.organ();
  std::vector<float> shape(3 * organ.vertices.size());
  for (std::size_t touch = 0; touch < organ.touches.size(); ++touch) {
    const auto triangle =
        std::ranges::find(organ.touch_of_triangle, static_cast<std::int32_t>(touch)) -
        organ.touch_of_triangle.begin();
    if (triangle == std::ssize(organ.triangles)) continue;
    const SurfacePoint place = {static_cast<std::int32_t>(triangle), {0.2, 0.3, 0.5}};
    const Eigen::Vector3d s = touched.positionOf(place);
    for (int piece = 0; piece < most_pieces && touched.prepare(touch, s); ++piece) {
    }
    for (const double x : {0.0, 0.003, -0.02, 1e300}) {
      touched.evaluate(touch, s, {x, -x, 0.5 * x});
      touched.shapeAt(touch, place, {x, -x, 0.5 * x}, shape);
    }
  }
}

void readOrgan(std::string_view bytes) {
  TouchedOrgan touched(decode(bytes));
  touchAll(touched);
}

std::vector<std::string> organSeeds() {
  CarriedOrgan refined = test::smallOrgan(true);
  refined.spaces[0].splits = {{{0, 0, 0}, 0}};
  return {encode(test::smallOrgan(false)), encode(test::smallOrgan(true)), encode(refined)};
}

const Registration organ_fuzzer({"organ", readOrgan, organSeeds});

}  // namespace
}  // namespace palpate::fuzz
