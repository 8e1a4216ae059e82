#pragma once

#include <algorithm>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// m: a place that is farther from the surface is not meant to lie on it. A quarter of the finger's
/// radius, or a millionth of the body's size where that is more.
inline double mostPlaceDistance(const Mesh& mesh, double finger_radius) {
  return std::max(0.25 * finger_radius, 1e-6 * boundingBox(mesh).diagonal().norm());
}

}  // namespace palpate
