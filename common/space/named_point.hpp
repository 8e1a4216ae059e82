#pragma once

#include "common/space/lattice.hpp"

namespace palpate {

/// The number of the lattice point that people name by its coordinates in spacings; refined ones
/// have fractions. Error (bad input), naming the bounds, when it is not in the lattice.
std::int32_t pointNamed(const Lattice& lattice, const Eigen::Vector3d& in_spacings);

}  // namespace palpate
