#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/index.hpp"
#include "viewer/organ/carried_organ.hpp"

namespace palpate {
namespace {

bool isPlace(const Eigen::Vector3d& v) { return (v.array().abs() <= farthest_node).all(); }
bool isNumberOf(std::int32_t n, std::size_t count) { return n >= 0 && at(n) < count; }
/// False for NaN.
bool isLength(double metres) { return metres > 0 && metres <= farthest_node; }

std::string faultOfSurface(const CarriedOrgan& organ) {
  if (organ.vertices.empty() || organ.vertices.size() > most_carried_vertices)
    return fmt::format("invalid number of vertices: {}", organ.vertices.size());
  for (std::size_t v = 0; v < organ.vertices.size(); ++v)
    if (!isPlace(organ.vertices[v])) return fmt::format("vertex {} has no valid position", v);
  if (organ.triangles.empty() || organ.touch_of_triangle.size() != organ.triangles.size())
    return fmt::format("invalid number of triangles: {}", organ.triangles.size());
  for (std::size_t t = 0; t < organ.triangles.size(); ++t) {
    const auto& [a, b, c] = organ.triangles[t];
    for (const std::int32_t corner : {a, b, c})
      if (!isNumberOf(corner, organ.vertices.size()))
        return fmt::format("triangle {} has an invalid corner {}", t, corner);
    if (a == b || b == c || c == a) return fmt::format("triangle {} has the same corner twice", t);
    const std::int32_t touch = organ.touch_of_triangle[t];
    if (touch != -1 && !isNumberOf(touch, organ.touches.size()))
      return fmt::format("triangle {} belongs to invalid part {}", t, touch);
  }
  return {};
}

std::string faultOfArea(const CarriedTouch& touch, const std::vector<SpaceTable>& spaces) {
  if (!isLength(touch.finger_radius)) return "invalid radius of the finger";
  if (touch.collocation_points.empty()) return "no collocation points";
  for (const Eigen::Vector3d& collocation_point : touch.collocation_points)
    if (!isPlace(collocation_point)) return "a collocation point has no valid position";
  const Lattice& first = spaces[at(touch.spaces.front())].lattice;
  for (const std::int32_t space : touch.spaces) {
    const auto& finger = spaces[at(space)].patch.finger;
    if (!finger || finger->radius != touch.finger_radius)
      return fmt::format("space {} belongs to another finger", space);
    const Lattice& lattice = spaces[at(space)].lattice;
    if (lattice.radius() != first.radius() || lattice.spacing() != first.spacing() ||
        lattice.divisions() != first.divisions())
      return fmt::format("the lattice of space {} differs from the others", space);
  }
  return {};
}

std::string faultOfTouch(const CarriedTouch& touch, const std::vector<SpaceTable>& spaces) {
  if (touch.spaces.empty()) return "no spaces";
  for (const std::int32_t space : touch.spaces)
    if (!isNumberOf(space, spaces.size())) return fmt::format("invalid space {}", space);
  if (!isPlace(touch.rest)) return "no valid rest position";
  return touch.finger_radius == 0 ? "" : faultOfArea(touch, spaces);
}

std::string faultOfPoints(const SpaceTable& space) {
  const std::vector<PointRecord>& points = space.points;
  for (std::size_t n = 0; n < points.size(); ++n)
    if (isSolved(points[n].tag) && !isUsable(points[n].equilibrium))
      return fmt::format("point {} has a number that is not finite or exceeds {:g}", n,
                         largest_stored);
  return faultOf(space);
}

/// Returns the fault of these shapes; empty if there is none. Factors of modes
/// (CarriedShapes::shares) above a million radii of the workspace are a fault. Real factors are
/// smaller, because modes are orthonormal and displacements are about as large as that of the tool.
/// With such large factors, interpolated shapes would be nothing but rounding errors.
std::string faultOfShapes(const CarriedShapes& shapes, const std::vector<SpaceTable>& spaces) {
  // False for NaN.
  const auto areWithin = [](const std::vector<float>& values, double most) {
    return std::ranges::all_of(values, [most](float x) { return std::abs(x) <= most; });
  };
  if (shapes.mode_count == 0 || shapes.mode_count % 3 != 0)
    return fmt::format("its number of modes is {}, not a positive multiple of three",
                       shapes.mode_count);
  if (!areWithin(shapes.modes, 1.001)) return "a mode has an entry that is not between -1 and 1";
  for (std::size_t n = 0; n < spaces.size(); ++n)
    if (!areWithin(shapes.shares[n], 1e6 * spaces[n].lattice.radius()))
      return fmt::format("space {} has a shape that is not finite or far too large", n);
  return {};
}

}  // namespace

std::string faultOf(const CarriedOrgan& organ) {
  if (!(organ.max_force > 0 && organ.max_force <= largest_stored))
    return fmt::format("invalid force limit of {} N", organ.max_force);
  if (std::string fault = faultOfSurface(organ); !fault.empty()) return fault;
  for (std::size_t n = 0; n < organ.touches.size(); ++n)
    if (const std::string fault = faultOfTouch(organ.touches[n], organ.spaces); !fault.empty())
      return fmt::format("touchable part {}: {}", n, fault);
  for (std::size_t n = 0; n < organ.spaces.size(); ++n)
    if (const std::string fault = faultOfPoints(organ.spaces[n]); !fault.empty())
      return fmt::format("space {}: {}", n, fault);
  return faultOfShapes(organ.shapes, organ.spaces);
}

}  // namespace palpate
