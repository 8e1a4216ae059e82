#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// Pairs of triangles that intersect in more than shared corners and edges: they cut, touch,
/// overlap, or are folded onto each other.
struct SelfIntersections {
  std::int64_t count = 0;
  std::array<std::int32_t, 2> first = {-1, -1};  ///< the pair with the lowest numbers
};

/// Checks all pairs with intersecting bounding boxes, by a tree of boxes. A point counts as on a
/// plane if it is nearer to it than the rounding of its coordinates. Error with the exit code of an
/// interrupt if this process is interrupted.
SelfIntersections selfIntersectionsOf(const std::vector<Eigen::Vector3d>& points,
                                      const std::vector<Triangle>& triangles);

/// Refuses a body with a self-intersecting surface: inner faces that do not match, or parts in the
/// same place. Matching faces with separate nodes (a cut, parts that are not welded) are accepted.
/// Error (bad input) with the number of pairs and a position in the unit of the nodes, which need
/// not be metres yet. `source` names the file.
void refuseOverlaps(const Mesh& mesh, const std::string& source);

}  // namespace palpate
