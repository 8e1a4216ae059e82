#pragma once

#include <optional>
#include <string_view>

#include "viewer/report/compared_lattice.hpp"

namespace palpate {

/// An exact solution that the measured interpolations do not use.
struct HeldOutSolution {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< metres
  Eigen::Vector3d force = Eigen::Vector3d::Zero();         ///< N
};

/// Origin of a report's held-out solutions.
enum class HeldOutKind : std::uint8_t {
  probes,          ///< exact solutions at random positions, computed for measuring
  lattice_points,  ///< points of the densest lattice that the measured, coarser ones lack
  none,
};
std::string_view name(HeldOutKind kind);  ///< "probes", "left-out lattice points", "none"

/// The held-out solutions of a report.
struct HeldOut {
  HeldOutKind kind = HeldOutKind::none;
  std::vector<std::vector<HeldOutSolution>> of_space;  ///< per active node
  std::size_t count = 0;                               ///< all active nodes
  /// Index of the dataset that the lattice points come from.
  std::optional<std::size_t> source = {};

  /// Returns whether the solutions can measure a lattice, which must not contain them.
  bool measures(const ComparedLattice& lattice) const;
};

/// Returns the probes if there are any, else the points of the densest dataset that the other
/// `lattices` leave out.
HeldOut heldOutOf(const std::vector<Dataset>& datasets,
                  const std::vector<ComparedLattice>& lattices);

/// Returns the probes of all `tables` (one active node in several lattices) that were solved with a
/// force within max_force. Leaves out points of one of the lattices, and duplicates. Forces beyond
/// max_force are not rendered by any device, and reach thousands of newtons next to a crushed
/// element.
std::vector<HeldOutSolution> usableProbes(const std::vector<const SpaceTable*>& tables);

/// Returns the expandable points of `dense` that no lattice of `tables` contains.
std::vector<HeldOutSolution> leftOutPoints(const SpaceTable& dense,
                                           const std::vector<const SpaceTable*>& tables);

}  // namespace palpate
