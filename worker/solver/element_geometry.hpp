#pragma once

#include <Eigen/Core>
#include <limits>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// The nodes of an element: its vertices, then on a quadratic mesh the middles of its edges.
std::vector<std::int32_t> nodesOf(const Mesh& mesh, std::size_t element);

/// Gradients of the barycentric coordinates of an element's vertices, columns, 1/m.
Eigen::Matrix<double, 3, 4> barycentricGradients(const Mesh& mesh, std::size_t element);

/// The smallest det F of a body and where it is.
struct SmallestDetF {
  double det_F = std::numeric_limits<double>::infinity();
  std::int32_t element = -1;  ///< index into Mesh::tetrahedra
};

/// Of the nodes of the elements of a quadratic mesh; nothing on a linear one, where det F is the
/// same all over an element. Kernels look at quadrature points only, and det F is less at the
/// nodes. `u`: nNodes x 3 displacements, metres.
SmallestDetF smallestDetFAtNodes(const Mesh& mesh, const std::vector<double>& u);

}  // namespace palpate
