#pragma once

#include <string>
#include <vector>

#include "common/space/space_table.hpp"
#include "viewer/fields/force_field.hpp"

namespace palpate {

/// Displacements along one axis through the rest position, m, and the forces along the same axis
/// there, N; of equal length.
struct AxisForces {
  std::vector<double> displacements, forces;
};

/// The solved lattice points of `space` on an axis, 0 to 2.
AxisForces solvedForcesAlong(const SpaceTable& space, int axis);

/// Samples `field` from one side of the ball (radius in metres) to the other.
AxisForces sampleForcesAlong(const ForceField& field, double radius, int axis);

}  // namespace palpate
