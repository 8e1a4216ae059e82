#pragma once

#include <vector>

#include "viewer/fields/cell_field.hpp"

namespace palpate {

/// What to add to the energy of every slot, J, so that the energies contradict the forces less
/// where branches meet; zero but at corners of leaves with an inconsistent edge. Zero for hanging
/// slots: they follow their coarser leaf.
///
/// Over a jump between branches the body loses energy that no force at the ends of the edge
/// accounts for. A conservative force has to, with energy / length of the edge more than the ends
/// say (1.9 times that in the middle of a quintic), all in one leaf. Moving the energies at both
/// ends towards each other shares that out over the leaf and those before and behind it.
///
/// With f the force, N, that an edge of length h lacks to explain the difference of the energies at
/// its ends by the corrected trapezoidal rule (branch_check.hpp), dF the difference of the forces
/// at its ends along it, and x the corrections, this minimises
///   the sum over edges of max(0, |f| - 0.1 |dF|)^2 + the sum over slots of (x / h)^2,
/// h in the second sum of the shortest edge at the slot.
std::vector<double> energyCorrections(const CellData& data);

}  // namespace palpate
