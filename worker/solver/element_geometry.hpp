#pragma once

#include <Eigen/Core>
#include <limits>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// Returns the nodes of an element: its vertices, then on a quadratic mesh its mid-edge nodes.
std::vector<std::int32_t> nodesOf(const Mesh& mesh, std::size_t element);

/// Returns the gradients of an element's barycentric coordinates as columns, 1/m.
Eigen::Matrix<double, 3, 4> barycentricGradients(const Mesh& mesh, std::size_t element);

/// The smallest det F of a body and its element.
struct SmallestDetF {
  double det_F = std::numeric_limits<double>::infinity();
  std::int32_t element = -1;  ///< index into Mesh::tetrahedra
};

/// Returns the smallest det F at the nodes of a quadratic mesh; no element (-1) on a linear mesh,
/// where det F is constant per element. Kernels see only quadrature points, and det F is smaller at
/// the nodes. `u`: nNodes x 3 displacements, metres.
SmallestDetF smallestDetFAtNodes(const Mesh& mesh, const std::vector<double>& u);

}  // namespace palpate
