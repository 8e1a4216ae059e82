#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// The nodes of an element: its vertices, then on a quadratic mesh the middles of its edges.
std::vector<std::int32_t> nodesOf(const Mesh& mesh, std::size_t element);

/// Gradients of the barycentric coordinates of the first three vertices of an element, columns,
/// 1/m. The fourth is minus their sum.
Eigen::Matrix3d barycentricGradients(const Mesh& mesh, std::size_t element);

}  // namespace palpate
