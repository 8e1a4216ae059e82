#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "common/space/space_table.hpp"

namespace palpate {

/// An exact solution that the interpolations which are measured with it have not seen.
struct Reference {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< metres
  Eigen::Vector3d force = Eigen::Vector3d::Zero();         ///< N
};

/// Where references come from.
enum class ReferenceKind : std::uint8_t {
  probes,    ///< exact solutions at random positions, made to measure with
  left_out,  ///< lattice points of the densest lattice that the measured, coarser lattices do not
             ///< have
  none,
};
std::string_view name(ReferenceKind kind);  ///< "probes", "left-out lattice points", "none"

/// Probes of all `tables` (of one active node, in several lattices) that were solved with a force
/// within max_force, without those that are a point of one of the lattices, and each once. Beyond
/// max_force no device renders the force, and next to a crushed element it is thousands of newtons.
std::vector<Reference> usableProbes(const std::vector<const SpaceTable*>& tables);

/// Expandable points of `dense` that are in no lattice of `tables`.
std::vector<Reference> leftOutPoints(const SpaceTable& dense,
                                     const std::vector<const SpaceTable*>& tables);

}  // namespace palpate
