#pragma once

#include <array>
#include <string>
#include <vector>

#include "viewer/report/slice_map.hpp"

namespace palpate {

/// Displacements along one axis through the rest position, m, and the forces along the same axis
/// there, N; of equal length.
struct AxisForces {
  std::vector<double> displacements, forces;
};

/// Fields of one active node, sampled.
struct NodePictures {
  std::size_t node = 0;  ///< index into Report::nodes
  /// Planes xy, xz and yz, the default method on the shown lattice; empty when it cannot be made.
  std::vector<SliceMap> slices;
  // Along x, y and z, in the first dataset as it is.
  std::array<AxisForces, 3> solved;  ///< at the solved lattice points
  /// By method, in the order of Report::methods; empty where it cannot be made.
  std::vector<std::array<AxisForces, 3>> sampled;
};

/// Samples the first of `methods` in the planes of `shown`, the space as it is on the shown
/// lattice, and all of them along the axes of `whole`, as it is in the dataset. Does not set
/// NodePictures::node. Any thread; some tenths of a second.
NodePictures sampleNode(const SpaceTable& shown, const SpaceTable& whole,
                        const std::vector<std::string>& methods,
                        const std::vector<HeldOutSolution>& held_out);

}  // namespace palpate
