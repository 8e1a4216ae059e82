#include "worker/solver/element_geometry.hpp"

#include <Eigen/LU>

namespace palpate {

std::vector<std::int32_t> nodesOf(const Mesh& mesh, std::size_t element) {
  std::vector<std::int32_t> nodes(mesh.tetrahedra[element].begin(), mesh.tetrahedra[element].end());
  if (!mesh.mid_edge_nodes.empty())
    nodes.insert(nodes.end(), mesh.mid_edge_nodes[element].begin(),
                 mesh.mid_edge_nodes[element].end());
  return nodes;
}

Eigen::Matrix3d barycentricGradients(const Mesh& mesh, std::size_t element) {
  const Tetrahedron& tetrahedron = mesh.tetrahedra[element];
  Eigen::Matrix3d edges;
  for (int b = 0; b < 3; ++b)
    edges.row(b) = mesh.nodes[tetrahedron[b]] - mesh.nodes[tetrahedron[3]];
  return edges.inverse();
}

}  // namespace palpate
