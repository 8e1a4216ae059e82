#include "worker/solver/element_geometry.hpp"

#include "common/mesh/tetrahedron.hpp"
#include "worker/elements/shape_functions.hpp"
#include "worker/solver/body_model.hpp"

namespace palpate {
namespace {

using kernels_default::P2;

/// Returns F at a node of a quadratic element. The node is midway between the two vertices `ends`,
/// which are equal for a vertex. The columns of `gradients` are the gradients of the barycentric
/// coordinates, 1/m.
Eigen::Matrix3d deformationAt(const int (&ends)[P2::ends], const std::vector<std::int32_t>& nodes,
                              const Eigen::Matrix<double, 3, 4>& gradients,
                              const std::vector<double>& u) {
  double x[4] = {};
  for (const int end : ends) x[end] += 0.5;
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  for (int a = 0; a < P2::nodes; ++a) {
    const Eigen::Vector3d u_a = ofNode(u, nodes[a]);
    for (int e = 0; e < P2::ends; ++e)
      F += P2::slope(a, e, x) * u_a * gradients.col(P2::end[a][e]).transpose();
  }
  return F;
}

}  // namespace

SmallestDetF smallestDetFAtNodes(const Mesh& mesh, const std::vector<double>& u) {
  SmallestDetF smallest;
  if (mesh.mid_edge_nodes.empty()) return smallest;
  for (std::size_t element = 0; element < mesh.tetrahedra.size(); ++element) {
    const std::vector<std::int32_t> nodes = nodesOf(mesh, element);
    const Eigen::Matrix<double, 3, 4> gradients = barycentricGradients(mesh, element);
    for (const auto& ends : P2::end)
      if (const double det_F = deformationAt(ends, nodes, gradients, u).determinant();
          det_F < smallest.det_F)
        smallest = {det_F, static_cast<std::int32_t>(element)};
  }
  return smallest;
}

}  // namespace palpate
