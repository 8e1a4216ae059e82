#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// Pairs of triangles of a surface that intersect in more than their shared corners and edges: the
/// triangles cut or touch each other, overlap, or are folded onto each other.
struct SelfIntersections {
  std::int64_t count = 0;
  std::array<std::int32_t, 2> first = {-1, -1};  ///< the pair with the lowest numbers
};

/// Finds the self-intersections of a surface. Uses a tree of bounding boxes to find the pairs to
/// check. A point counts as on a plane if its distance is within the rounding of its coordinates.
/// Error with the exit code of an interrupt if this process is interrupted.
SelfIntersections selfIntersectionsOf(const std::vector<Eigen::Vector3d>& points,
                                      const std::vector<Triangle>& triangles);

/// Refuses a body with a self-intersecting surface. Such a body has inner faces that do not match,
/// or parts that overlap. Faces that match but have separate nodes (a cut, or parts that are not
/// welded) are accepted. Error (bad input) that gives the number of intersecting pairs and one
/// position, in the unit of the nodes, which need not be metres yet. `source` names the file in the
/// message.
void refuseOverlaps(const Mesh& mesh, const std::string& source);

}  // namespace palpate
