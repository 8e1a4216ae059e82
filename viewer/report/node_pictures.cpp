#include "viewer/report/node_pictures.hpp"

#include <cmath>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "viewer/report/field_comparison.hpp"

namespace palpate {
namespace {

/// A slice shows held-out solutions whose distance from its plane is below this fraction of the
/// radius.
constexpr double shown_distance = 0.05;
constexpr int bound_samples = 13;  ///< along an axis
constexpr std::array<std::array<int, 2>, 3> planes = {{{0, 1}, {0, 2}, {1, 2}}};

using Fields = std::vector<std::unique_ptr<ForceField>>;

/// Returns the fields of all methods; null for a method that cannot be made.
Fields fieldsOf(const SpaceTable& space, const std::vector<std::string>& methods) {
  return mapped(methods, [&](const std::string& method) { return tryToMake(method, space).field; });
}

void sampleAll(const Fields& fields, double from, double to, ForceWay& way) {
  for (const auto& field : fields) {
    AxisForces& sampled = way.sampled.emplace_back();
    if (!field) continue;
    sampled = sampledOnWay([&](const Eigen::Vector3d& p) { return field->evaluate(p).force; },
                           way.direction, from, to);
  }
}

/// Samples all fields along an axis, from one side of the ball to the other.
ForceWay axisOf(const SpaceTable& space, const Fields& fields, int axis) {
  static constexpr std::array<const char*, 3> names = {"x", "y", "z"};
  ForceWay way = {.name = names[axis], .direction = Eigen::Vector3d::Unit(axis)};
  way.solved = solvedOnWay(space, way.direction, true);
  sampleAll(fields, -space.lattice.radius(), space.lattice.radius(), way);
  return way;
}

std::vector<ForceWay> tellingWays(const SpaceTable& space, const Fields& fields,
                                  const std::vector<HeldOutSolution>& held_out) {
  if (!fields.front()) return {};
  std::vector<double> errors;
  for (const HeldOutSolution& solution : held_out)
    // A solution at rest defines no direction.
    errors.push_back(
        solution.displacement.norm() > 0
            ? (fields.front()->evaluate(solution.displacement).force - solution.force).norm()
            : not_measured);
  std::vector<ForceWay> ways;
  for (const auto& [n, name] : tellingOnes(errors)) {
    ForceWay way = {.name = name, .direction = held_out[n].displacement.normalized()};
    way.solved = solvedOnWay(space, way.direction, false);
    way.held_out = heldOutOnWay(held_out, space.lattice.radius(), way.direction, false);
    sampleAll(fields, 0, space.lattice.radius(), way);
    ways.push_back(std::move(way));
  }
  return ways;
}

}  // namespace

SliceMap sampleSlice(const ForceField& field, const SpaceTable& space, int across, int up,
                     const std::vector<HeldOutSolution>& held_out) {
  PALPATE_ASSERT(across != up && across + up <= 3, "a plane must use two of the three axes");
  SliceMap map;
  map.across = across;
  map.up = up;
  map.radius = space.lattice.radius();
  const int normal = 3 - across - up;
  const auto in_plane = [&](const Eigen::Vector3d& p) { return Eigen::Vector2d(p[across], p[up]); };
  const auto is_in_plane = [&](std::int32_t n) { return space.lattice.point(n)[normal] == 0; };
  // The samples are at the centres of the picture's squares.
  for (int row = 0; row < SliceMap::side; ++row)
    for (int column = 0; column < SliceMap::side; ++column) {
      Eigen::Vector3d p = Eigen::Vector3d::Zero();
      p[across] = map.radius * (2 * (column + 0.5) / SliceMap::side - 1);
      p[up] = map.radius * (2 * (row + 0.5) / SliceMap::side - 1);
      const ForceSample sample = field.evaluate(p);
      const bool is_shown = p.norm() <= map.radius && sample.inside;
      map.bound.push_back(is_shown ? sample.error_bound : not_measured);
      map.covered.push_back(is_shown && isCovered(sample));
    }
  for (std::int32_t n = 0; n < space.lattice.size(); ++n)
    if (const Eigen::Vector3d p = space.lattice.displacement(n);
        is_in_plane(n) && p.norm() <= map.radius * (1 + 1e-9))
      map.marks.push_back({in_plane(p), space.points[n].tag});
  for (const LatticeEdge& jump : space.inconsistent_edges)
    if (is_in_plane(jump.a) && is_in_plane(jump.b))
      map.jumps.push_back({in_plane(space.lattice.displacement(jump.a)),
                           in_plane(space.lattice.displacement(jump.b))});
  for (const HeldOutSolution& solution : held_out) {
    const Eigen::Vector3d& p = solution.displacement;
    if (std::abs(p[normal]) < shown_distance * map.radius)
      map.errors.push_back({in_plane(p), (field.evaluate(p).force - solution.force).norm()});
  }
  return map;
}

Spread sampleBounds(const ForceField& field, double radius) {
  std::vector<double> bounds;
  const auto place = [&](int n) { return radius * (2.0 * n / (bound_samples - 1) - 1); };
  for (int i = 0; i < bound_samples; ++i)
    for (int j = 0; j < bound_samples; ++j)
      for (int k = 0; k < bound_samples; ++k) {
        const ForceSample sample = field.evaluate({place(i), place(j), place(k)});
        if (sample.inside && std::isfinite(sample.error_bound))
          bounds.push_back(sample.error_bound);
      }
  return spreadOf(std::move(bounds));
}

NodePictures sampleNode(const SpaceTable& shown, const SpaceTable& whole,
                        const std::vector<std::string>& methods,
                        const std::vector<HeldOutSolution>& held_out) {
  PALPATE_ASSERT(!methods.empty(), "at least one method must be given");
  NodePictures pictures;
  const Fields on_shown = fieldsOf(shown, methods);
  if (on_shown.front())
    for (const auto& [across, up] : planes)
      pictures.slices.push_back(sampleSlice(*on_shown.front(), shown, across, up, held_out));
  const Fields on_whole = fieldsOf(whole, methods);
  for (int axis = 0; axis < 3; ++axis) pictures.axes.push_back(axisOf(whole, on_whole, axis));
  pictures.ways = tellingWays(shown, on_shown, held_out);
  return pictures;
}

}  // namespace palpate
