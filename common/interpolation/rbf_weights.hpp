#pragma once

#include <cstddef>
#include <vector>

#include "common/space/rbf_weights_table.hpp"
#include "common/space/space_table.hpp"

namespace palpate {

/// More solved points than this are refused: the matrix of 5000 takes 0.2 GB, and the time grows
/// with the third power (docs/numerics.md).
inline constexpr std::size_t most_rbf_points = 5000;

/// Weights without and with a tail, in this order, from one dense factorisation. The same bits on
/// every x86-64 machine. Error when the space has no solved point or more than most_rbf_points.
std::vector<RbfWeights> solveRbfWeights(const SpaceTable& space, RbfKernel kernel);

}  // namespace palpate
