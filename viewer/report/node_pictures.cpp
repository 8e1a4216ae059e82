#include "viewer/report/node_pictures.hpp"

#include <cmath>

#include "common/base/assertion.hpp"
#include "viewer/report/field_comparison.hpp"

namespace palpate {
namespace {

/// Held-out solutions nearer to the plane than this share of the radius are shown in it.
constexpr double shown_distance = 0.05;
constexpr int samples = 121;  ///< along an axis
constexpr std::array<std::array<int, 2>, 3> planes = {{{0, 1}, {0, 2}, {1, 2}}};

AxisForces solvedForcesAlong(const SpaceTable& space, int axis) {
  AxisForces solved;
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    const Eigen::Vector3d p = space.lattice.displacement(n);
    // The other coordinates are exact zeros there.
    const bool is_on_axis = p.cwiseAbs().sum() == std::abs(p[axis]);
    if (!is_on_axis || p.norm() > space.lattice.radius() * (1 + 1e-9) ||
        !isSolved(space.points[n].tag))
      continue;
    solved.displacements.push_back(p[axis]);
    solved.forces.push_back(space.points[n].equilibrium.force[axis]);
  }
  return solved;
}

/// From one side of the ball (radius in metres) to the other.
AxisForces sampledForcesAlong(const ForceField& field, double radius, int axis) {
  AxisForces sampled;
  for (int n = 0; n < samples; ++n) {
    const double distance = radius * (2.0 * n / (samples - 1) - 1);
    sampled.displacements.push_back(distance);
    sampled.forces.push_back(field.evaluate(distance * Eigen::Vector3d::Unit(axis)).force[axis]);
  }
  return sampled;
}

}  // namespace

SliceMap sampleSlice(const ForceField& field, const SpaceTable& space, int across, int up,
                     const std::vector<HeldOutSolution>& held_out) {
  PALPATE_ASSERT(across != up && across + up <= 3, "a plane has two axes of three");
  SliceMap map;
  map.across = across;
  map.up = up;
  map.radius = space.lattice.radius();
  const int normal = 3 - across - up;
  const auto in_plane = [&](const Eigen::Vector3d& p) { return Eigen::Vector2d(p[across], p[up]); };
  const auto is_in_plane = [&](std::int32_t n) { return space.lattice.point(n)[normal] == 0; };
  // At the middles of the squares that the picture is made of.
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

NodePictures sampleNode(const SpaceTable& shown, const SpaceTable& whole,
                        const std::vector<std::string>& methods,
                        const std::vector<HeldOutSolution>& held_out) {
  PALPATE_ASSERT(!methods.empty(), "one method is the default");
  NodePictures pictures;
  if (const auto field = tryToMake(methods.front(), shown).field)
    for (const auto& [across, up] : planes)
      pictures.slices.push_back(sampleSlice(*field, shown, across, up, held_out));
  for (int axis = 0; axis < 3; ++axis) pictures.solved[axis] = solvedForcesAlong(whole, axis);
  for (const std::string& method : methods) {
    std::array<AxisForces, 3>& sampled = pictures.sampled.emplace_back();
    if (const auto field = tryToMake(method, whole).field)
      for (int axis = 0; axis < 3; ++axis)
        sampled[axis] = sampledForcesAlong(*field, whole.lattice.radius(), axis);
  }
  return pictures;
}

}  // namespace palpate
