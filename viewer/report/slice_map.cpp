#include "viewer/report/slice_map.hpp"

#include <cmath>

#include "viewer/report/error_measures.hpp"
#include "viewer/report/field_comparison.hpp"

namespace palpate {
namespace {

/// Held-out solutions nearer to the plane than this share of the radius are shown in it.
constexpr double shown_distance = 0.05;

}  // namespace

SliceMap sampleSlice(const ForceField& field, const SpaceTable& space, int across, int up,
                     const std::vector<HeldOutSolution>& held_out) {
  SliceMap map;
  map.across = across;
  map.up = up;
  map.radius = space.lattice.radius();
  const int normal = 3 - across - up;
  const auto in_plane = [&](const Eigen::Vector3d& p) { return Eigen::Vector2d(p[across], p[up]); };
  const auto is_in_plane = [&](std::int32_t n) {
    return space.lattice.point(n)[static_cast<std::size_t>(normal)] == 0;
  };
  for (int row = 0; row < SliceMap::side; ++row)
    for (int column = 0; column < SliceMap::side; ++column) {
      Eigen::Vector3d p = Eigen::Vector3d::Zero();
      p[across] = map.radius * (2 * (column + 0.5) / SliceMap::side - 1);
      p[up] = map.radius * (2 * (row + 0.5) / SliceMap::side - 1);
      const ForceSample sample = field.evaluate(p);
      const bool is_shown = p.norm() <= map.radius && sample.inside;
      map.bound.push_back(is_shown ? sample.error_bound : not_measured);
      map.covered.push_back(is_shown && isCovered(sample) ? 1 : 0);
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

}  // namespace palpate
