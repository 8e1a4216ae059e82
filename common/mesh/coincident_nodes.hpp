#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace palpate {

/// Nodes no farther from each other than this, in diagonals of the body, are one place: six digits
/// leave no more.
inline constexpr double coincident_distance = 1e-6;

/// The nodes that lie within `near` (m) of one of a lower number, by chains too: {node, the lowest
/// of its place}, ascending.
std::vector<std::array<std::int32_t, 2>> coincidentNodes(const std::vector<Eigen::Vector3d>& nodes,
                                                         double near);

}  // namespace palpate
