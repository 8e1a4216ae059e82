#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// Pairs of triangles that have more in common than corners and edges that they share: that cut,
/// touch, overlap, or are folded onto each other.
struct SelfIntersections {
  std::int64_t count = 0;
  std::array<std::int32_t, 2> first = {-1, -1};  ///< the pair with the lowest numbers
};

/// Looks at all pairs whose bounding boxes meet, by a tree of boxes. A point that is nearer to a
/// plane than its coordinates are rounded counts as on it.
/// Error with the exit code of an interrupt when this process is interrupted.
SelfIntersections selfIntersectionsOf(const std::vector<Eigen::Vector3d>& points,
                                      const std::vector<Triangle>& triangles);

/// Refuses a body whose surface overlaps itself: inner faces that do not match, or parts in one
/// place. Faces that match but have nodes of their own (a cut, parts that are not welded) are left.
/// Error (bad input) with the number of pairs and a place in the unit of the nodes, which need not
/// be metres yet; `source` names the file.
void refuseOverlaps(const Mesh& mesh, const std::string& source);

}  // namespace palpate
