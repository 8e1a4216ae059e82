#include "common/mesh/self_intersections.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <unsupported/Eigen/BVH>

#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/base/program.hpp"
#include "common/mesh/surface_point.hpp"

namespace palpate {
namespace {

using Corners = std::array<Eigen::Vector3d, 3>;

/// Relative rounding error of coordinates. A corner counts as on a plane or line if its distance is
/// within this tolerance.
constexpr double rounding = 32 * std::numeric_limits<double>::epsilon();
/// Two planes count as one if they are closer together than this number of rounding errors.
/// Rounding alone would decide where such planes intersect.
constexpr double one_plane = 1000;

double size(const Eigen::Vector3d& v) { return v.cwiseAbs().maxCoeff(); }

/// Returns on which side of the plane through a, b, c the point d lies: 1, -1, or 0 if its distance
/// is within `slack` rounding errors.
int sideOf(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
           const Eigen::Vector3d& d, double slack = 1) {
  const Eigen::Vector3d u = b - a, v = c - a, w = d - a;
  const double volume = u.cross(v).dot(w);
  const double zero = slack * rounding * std::max({size(a), size(b), size(c), size(d)}) *
                      (size(v) * size(w) + size(u) * size(w) + size(u) * size(v));
  return volume > zero ? 1 : volume < -zero ? -1 : 0;
}

/// Returns the orientation of a, b, c after projection along the coordinate `axis`: 1, -1 or 0.
int turnOf(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, int axis) {
  const int x = (axis + 1) % 3, y = (axis + 2) % 3;
  const double ux = b[x] - a[x], uy = b[y] - a[y], vx = c[x] - a[x], vy = c[y] - a[y];
  const double area = ux * vy - uy * vx;
  const double zero = rounding * std::max({size(a), size(b), size(c)}) *
                      (std::abs(ux) + std::abs(uy) + std::abs(vx) + std::abs(vy));
  return area > zero ? 1 : area < -zero ? -1 : 0;
}

/// Returns whether two triangles in one plane overlap. They do not if the line through an edge of
/// one triangle separates it from the other.
bool overlapInPlane(const Corners& s, const Corners& t) {
  int axis = 0;
  (s[1] - s[0]).cross(s[2] - s[0]).cwiseAbs().maxCoeff(&axis);
  const auto keepsApart = [axis](const Corners& of, int i, const Corners& other) {
    const Eigen::Vector3d &a = of[i], &b = of[(i + 1) % 3];
    const int inside = turnOf(a, b, of[(i + 2) % 3], axis);
    return std::ranges::all_of(other,
                               [&](const auto& p) { return inside * turnOf(a, b, p, axis) <= 0; });
  };
  for (int i = 0; i < 3; ++i)
    if (keepsApart(s, i, t) || keepsApart(t, i, s)) return false;
  return true;
}

/// Returns whether a segment and a triangle intersect. False for a segment in the triangle's plane.
bool meets(const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Corners& t) {
  const int from = sideOf(t[0], t[1], t[2], p, one_plane),
            to = sideOf(t[0], t[1], t[2], q, one_plane);
  if (from * to > 0 || (from == 0 && to == 0)) return false;
  const std::array<int, 3> around = {sideOf(p, q, t[0], t[1]), sideOf(p, q, t[1], t[2]),
                                     sideOf(p, q, t[2], t[0])};
  const auto [least, most] = std::ranges::minmax(around);
  // The segment passes through the triangle or its boundary if the signs do not differ. If all are
  // zero, the segment is in line with all three edges, which is not an intersection.
  return least * most >= 0 && (least != 0 || most != 0);
}

bool isFlatOn(const Corners& s, const Corners& t) {
  return std::ranges::all_of(
      s, [&](const auto& p) { return sideOf(t[0], t[1], t[2], p, one_plane) == 0; });
}

/// Returns whether the edge of `s` opposite the shared corner meets `t`.
bool edgeBeside(const std::array<bool, 3>& shared, const Corners& s, const Corners& t) {
  for (int i = 0; i < 3; ++i)
    if (shared[i]) return meets(s[(i + 1) % 3], s[(i + 2) % 3], t);
  return false;
}

/// Decides whether two triangles intersect in more than their shared corners and edges.
bool cutEachOther(const std::vector<Eigen::Vector3d>& points, const Triangle& s,
                  const Triangle& t) {
  std::array<bool, 3> of_s{}, of_t{};  // whether each corner is shared
  int shared = 0;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      if (s[i] == t[k]) {
        of_s[i] = of_t[k] = true;
        ++shared;
      }
  const Corners p = cornersOf(points, s), q = cornersOf(points, t);
  // Triangles that share an edge, or lie in one plane, can intersect further only if they overlap
  // in that plane.
  if (shared >= 2 || isFlatOn(p, q)) return isFlatOn(p, q) && overlapInPlane(p, q);
  if (shared == 1) return edgeBeside(of_s, p, q) || edgeBeside(of_t, q, p);
  for (int i = 0; i < 3; ++i)
    if (meets(p[i], p[(i + 1) % 3], q) || meets(q[i], q[(i + 1) % 3], p)) return true;
  return false;
}

/// Visitor for Eigen's tree of boxes. Counts the triangles with a higher number than `triangle`
/// that intersect it.
struct CutsOfOne {
  const std::vector<Eigen::Vector3d>& points;
  const std::vector<Triangle>& triangles;
  const std::vector<Eigen::AlignedBox3d>& boxes;
  std::int32_t triangle;
  std::int64_t count = 0;
  std::int32_t lowest = -1;

  bool intersectVolume(const Eigen::AlignedBox3d& volume) const {
    return volume.intersects(boxes[triangle]);
  }
  /// Checks one triangle. Returns false, so that the search continues.
  bool intersectObject(std::int32_t other) {
    if (other > triangle && boxes[other].intersects(boxes[triangle]) &&
        cutEachOther(points, triangles[triangle], triangles[other])) {
      ++count;
      if (lowest < 0 || other < lowest) lowest = other;
    }
    return false;
  }
};

}  // namespace

SelfIntersections selfIntersectionsOf(const std::vector<Eigen::Vector3d>& points,
                                      const std::vector<Triangle>& triangles) {
  std::vector<Eigen::AlignedBox3d> boxes(triangles.size());
  const std::vector<std::int32_t> numbers = countUp(triangles.size());
  // The boxes of the tree are rotated. With axis-aligned boxes, the tree might split the triangles
  // of an axis-aligned face along the face's normal into two sets that both extend over the whole
  // face.
  const Eigen::Matrix3d oblique(Eigen::AngleAxisd(1, Eigen::Vector3d(1, 2, 3).normalized()));
  for (const std::int32_t t : numbers)
    for (const std::int32_t node : triangles[t]) boxes[t].extend(oblique * points[node]);
  const Eigen::KdBVH<double, 3, std::int32_t> tree(numbers.begin(), numbers.end(), boxes.begin(),
                                                   boxes.end());
  SelfIntersections cuts;
  for (const std::int32_t a : numbers) {
    endWhenInterrupted();
    CutsOfOne query{points, triangles, boxes, a};
    Eigen::BVIntersect(tree, query);
    cuts.count += query.count;
    if (query.lowest >= 0 && cuts.first[0] < 0) cuts.first = {a, query.lowest};
  }
  return cuts;
}

void refuseOverlaps(const Mesh& mesh, const std::string& source) {
  std::vector<std::int32_t> place_of = countUp(mesh.nodes.size());
  const double near = coincident_distance * boundingBox(mesh).diagonal().norm();
  for (const auto& [node, lowest] : coincidentNodes(mesh.nodes, near)) place_of[node] = lowest;
  const auto placesOf = [&](Triangle triangle) {
    for (std::int32_t& node : triangle) node = place_of[node];
    std::ranges::sort(triangle);
    return triangle;
  };
  std::map<Triangle, std::int32_t> sides;
  for (const Triangle& triangle : mesh.surface) ++sides[placesOf(triangle)];
  std::vector<Triangle> places;
  for (const auto& [triangle, count] : sides) {
    const bool is_cut = count == 2;
    if (!is_cut && std::ranges::adjacent_find(triangle) == triangle.end())
      places.insert(places.end(), at(count), triangle);
  }
  const SelfIntersections cuts = selfIntersectionsOf(mesh.nodes, places);
  if (cuts.count == 0) return;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const std::int32_t node : places[cuts.first[0]]) middle += mesh.nodes[node] / 3;
  throw badInput(
      "{}: {} pairs of surface triangles overlap or intersect, the first at {}: inner faces do not "
      "match, or parts overlap; mesh all parts together (gmsh: BooleanFragments), so that "
      "neighbours share whole faces",
      source, cuts.count, placeText(middle));
}

}  // namespace palpate
