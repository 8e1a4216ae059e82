#pragma once

#include <optional>
#include <string_view>

#include "viewer/report/compared_lattice.hpp"

namespace palpate {

/// An exact solution that was held out: the interpolations which are measured with it have not
/// seen it.
struct HeldOutSolution {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< metres
  Eigen::Vector3d force = Eigen::Vector3d::Zero();         ///< N
};

/// Where the held-out solutions of a report come from.
enum class HeldOutKind : std::uint8_t {
  probes,          ///< exact solutions at random positions, made to measure with
  lattice_points,  ///< points of the densest lattice that the coarser, measured ones do not have
  none,
};
std::string_view name(HeldOutKind kind);  ///< "probes", "left-out lattice points", "none"

/// The held-out solutions of a report.
struct HeldOut {
  HeldOutKind kind = HeldOutKind::none;
  std::vector<std::vector<HeldOutSolution>> of_space;  ///< per active node
  std::size_t count = 0;                               ///< all active nodes
  /// The dataset whose lattice points they are.
  std::optional<std::size_t> source = {};

  /// Whether a lattice can be measured with them: they are no points of it.
  bool measures(const ComparedLattice& lattice) const;
};

/// Probes where there are any, else points of the densest dataset that the other `lattices` leave
/// out.
HeldOut heldOutOf(const std::vector<Dataset>& datasets,
                  const std::vector<ComparedLattice>& lattices);

/// Probes of all `tables` (of one active node, in several lattices) that were solved with a force
/// within max_force, without those that are a point of one of the lattices, and each once. Beyond
/// max_force no device renders the force, and next to a crushed element it is thousands of newtons.
std::vector<HeldOutSolution> usableProbes(const std::vector<const SpaceTable*>& tables);

/// Expandable points of `dense` that are in no lattice of `tables`.
std::vector<HeldOutSolution> leftOutPoints(const SpaceTable& dense,
                                           const std::vector<const SpaceTable*>& tables);

}  // namespace palpate
