#pragma once

#include "viewer/fields/force_field.hpp"

namespace palpate {

/// The work that a force field does around closed loops, relative to the effort: |sum F . dp| / sum
/// |F| |dp|, the largest over circles of a quarter of `radius` (metres, of the workspace ball) with
/// random centres and planes from a fixed seed, all inside the ball. Zero for a conservative field,
/// apart from the error of 4096-point quadrature (some 1e-9). Circles on which the coverage falls
/// below `least_coverage` anywhere are left out, up to 64 are used; NaN when none is left. Takes
/// some 0.1 s.
double loopWork(const ForceField& field, double radius, double least_coverage = 0);

}  // namespace palpate
