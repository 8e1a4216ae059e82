#pragma once

#include <optional>
#include <string_view>

#include "viewer/report/compared_lattice.hpp"

namespace palpate {

/// An exact solution that the measured interpolations do not use, so that it can measure their
/// errors.
struct HeldOutSolution {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< metres
  Eigen::Vector3d force = Eigen::Vector3d::Zero();         ///< N
};

/// Origin of the held-out solutions of a report.
enum class HeldOutKind : std::uint8_t {
  probes,          ///< exact solutions at random positions, computed only to measure errors
  lattice_points,  ///< points of the densest lattice that the measured lattices do not contain
  none,
};
std::string_view name(HeldOutKind kind);  ///< "probes", "left-out lattice points", "none"

/// The held-out solutions of a report.
struct HeldOut {
  HeldOutKind kind = HeldOutKind::none;
  std::vector<std::vector<HeldOutSolution>> of_space;  ///< per active node
  std::size_t count = 0;                               ///< total number at all active nodes
  /// Index of the dataset from which lattice points come; empty for probes.
  std::optional<std::size_t> source = {};

  /// Returns whether these solutions can measure a lattice. They cannot if the lattice contains
  /// them.
  bool measures(const ComparedLattice& lattice) const;
};

/// Returns the probes if there are any. Otherwise returns the points of the densest dataset that
/// are in none of the other `lattices`.
HeldOut heldOutOf(const std::vector<Dataset>& datasets,
                  const std::vector<ComparedLattice>& lattices);

/// Returns the usable probes of one active node. tables: the active node in several lattices.
///
/// A probe is usable if it was solved with a force within max_force, and is not a point of one of
/// the lattices. Duplicates are left out. Forces beyond max_force are not used, because no device
/// renders them, and next to a crushed element they reach thousands of newtons.
std::vector<HeldOutSolution> usableProbes(const std::vector<const SpaceTable*>& tables);

/// Returns the points of `dense` that no lattice of `tables` contains. Only solved points with a
/// force within max_force are returned (Tag::expandable).
std::vector<HeldOutSolution> leftOutPoints(const SpaceTable& dense,
                                           const std::vector<const SpaceTable*>& tables);

}  // namespace palpate
