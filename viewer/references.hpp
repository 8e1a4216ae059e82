#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "common/dataset.hpp"

namespace palpate {

/// An exact solution that the interpolations which are measured with it have not seen.
struct Reference {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< metres
  Eigen::Vector3d force = Eigen::Vector3d::Zero();         ///< N
};

/// Where references come from.
enum class ReferenceKind : std::uint8_t {
  probes,    ///< exact solutions at random positions, made to measure with
  left_out,  ///< lattice points of the densest lattice that the measured, coarser lattices do not have
  none,
};
std::string_view name(ReferenceKind kind);  ///< "probes", "left-out lattice points", "none"

/// Solved probes of all `tables` (of one active node, in several lattices), without those that are a point of
/// one of the lattices, and each once.
std::vector<Reference> solvedProbes(const std::vector<const SpaceTable*>& tables);

/// Solved points of `dense` that are in no lattice of `tables`.
std::vector<Reference> leftOutPoints(const SpaceTable& dense, const std::vector<const SpaceTable*>& tables);

}  // namespace palpate
