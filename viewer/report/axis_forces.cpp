#include "viewer/report/axis_forces.hpp"

#include <cmath>

namespace palpate {
namespace {

constexpr int samples = 121;

}  // namespace

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

AxisForces sampleForcesAlong(const ForceField& field, double radius, int axis) {
  AxisForces sampled;
  for (int n = 0; n < samples; ++n) {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    p[axis] = radius * (2.0 * n / (samples - 1) - 1);
    sampled.displacements.push_back(p[axis]);
    sampled.forces.push_back(field.evaluate(p).force[axis]);
  }
  return sampled;
}

}  // namespace palpate
