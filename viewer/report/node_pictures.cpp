#include "viewer/report/node_pictures.hpp"

#include <cmath>

#include "common/base/assertion.hpp"
#include "viewer/report/field_comparison.hpp"

namespace palpate {
namespace {

constexpr int samples = 121;
constexpr std::array<std::array<int, 2>, 3> planes = {{{0, 1}, {0, 2}, {1, 2}}};

AxisForces solvedForcesAlong(const SpaceTable& space, int axis) {
  AxisForces solved;
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    const Eigen::Vector3d p = space.lattice.displacement(n);
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
