#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// Pairs of triangles that have more in common than corners and edges that they share: that cut,
/// touch, overlap, or are folded onto each other.
struct SurfaceCuts {
  std::int64_t count = 0;
  std::array<std::int32_t, 2> first = {-1, -1};  ///< the pair with the lowest numbers
};

/// Looks at all pairs whose bounding boxes meet, by a tree of boxes. Sides of planes are told in
/// extended precision, and by less than its round-off a point counts as on the plane.
/// Error with the exit code of an interrupt when this process is interrupted.
SurfaceCuts cutsOf(const std::vector<Eigen::Vector3d>& points,
                   const std::vector<Triangle>& triangles);

}  // namespace palpate
