#pragma once

#include <vector>

#include "common/interpolation/branch_check.hpp"
#include "common/interpolation/cell_tree.hpp"
#include "common/space/space_table.hpp"

namespace palpate {

/// Energy, force and stiffness for every slot of a tree, for methods that interpolate nodal data.
///
///   solved   those of the lattice point
///   ghost    those of the local polynomial of the energy (energy_jets.hpp)
///   hanging  zero: the method fills them itself (fillHanging in cell_tree.hpp)
///
/// A ghost's polynomial goes through the data of the nearest solved points: exact for energies up
/// to the third degree where enough of them are near, of lower order with fewer; a lone point is
/// continued by its force and stiffness. Forces are limited by what the neighbours span.
/// Points that an inconsistent edge joins to another are not used together for one ghost.
/// The same numbers on every machine of one kind. Any thread.
std::vector<Equilibrium> slotEquilibria(const CellTree& tree, const SpaceTable& space,
                                        const std::vector<LatticeEdge>& inconsistent);

/// For every slot the share (0..1) of it that stands on solved points without an inconsistent edge:
/// 1, 0 for ghosts and ends of inconsistent edges, in between where a slot hangs. Interpolated
/// tri-linearly in a leaf it is the coverage of a sample.
std::vector<double> slotCoverage(const CellTree& tree,
                                 const std::vector<LatticeEdge>& inconsistent);

}  // namespace palpate
