#pragma once

#include <Eigen/LU>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// Returns the nodes of an element: its vertices, then on a quadratic mesh its mid-edge nodes.
inline std::vector<std::int32_t> nodesOf(const Mesh& mesh, std::size_t element) {
  std::vector<std::int32_t> nodes(mesh.tetrahedra[element].begin(), mesh.tetrahedra[element].end());
  if (!mesh.mid_edge_nodes.empty())
    nodes.insert(nodes.end(), mesh.mid_edge_nodes[element].begin(),
                 mesh.mid_edge_nodes[element].end());
  return nodes;
}

/// Returns the gradients of an element's barycentric coordinates as columns, 1/m.
inline Eigen::Matrix<double, 3, 4> barycentricGradients(const Mesh& mesh, std::size_t element) {
  const Tetrahedron& tetrahedron = mesh.tetrahedra[element];
  Eigen::Matrix3d edges;
  for (int b = 0; b < 3; ++b)
    edges.row(b) = mesh.nodes[tetrahedron[b]] - mesh.nodes[tetrahedron[3]];
  Eigen::Matrix<double, 3, 4> gradients;
  gradients.leftCols<3>() = edges.inverse();
  gradients.col(3) = -gradients.leftCols<3>().rowwise().sum();
  return gradients;
}

}  // namespace palpate
