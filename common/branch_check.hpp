#pragma once

#include <cstdint>
#include <vector>

#include "common/dataset.hpp"

namespace palpate {

/// Two lattice points that are joined by an edge of a leaf cell.
struct LatticeEdge {
  std::int32_t a = -1, b = -1;  ///< lattice numbers, a < b
  auto operator<=>(const LatticeEdge&) const = default;
};

/// How well one equilibrium, `step` metres from another, continues it.
struct EdgeCheck {
  double mismatch = 0;   ///< N, |F_b - F_a - (K_a + K_b) / 2 step|: what the stiffnesses do not explain
  double allowance = 0;  ///< N, the mismatch that a smooth branch may have
  bool consistent() const { return mismatch <= allowance; }
};
EdgeCheck checkEdge(const Equilibrium& a, const Equilibrium& b, const Eigen::Vector3d& step);

/// The edges whose two ends lie on different branches of solutions, or with a fold between: no interpolation
/// may treat the force between them as smooth. Sorted by (a, b). Points that are not solved are in no edge.
///
/// Tested are the edges of the leaf cells: the cells of the uniform lattice, and the eighths of split cells,
/// that were not split themselves. So in an unrefined lattice every pair of solved points one spacing apart
/// along an axis, and where levels meet the whole edge of the coarse cell and the halves of the fine one.
/// Costs some 0.1 us per point and level. Any thread.
std::vector<LatticeEdge> inconsistentEdges(const SpaceTable& space);

}  // namespace palpate
