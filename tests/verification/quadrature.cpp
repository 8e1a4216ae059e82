#include "tests/verification/quadrature.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "common/base/assertion.hpp"

namespace palpate::verification {
namespace {

/// Returns the points and weights of the n-point Gauss-Legendre rule on [0, 1]. The points are the
/// eigenvalues of the Jacobi matrix of the Legendre polynomials (Golub and Welsch 1969).
std::pair<Eigen::VectorXd, Eigen::VectorXd> gaussLegendre(int n) {
  Eigen::MatrixXd jacobi = Eigen::MatrixXd::Zero(n, n);
  for (int i = 1; i < n; ++i) jacobi(i, i - 1) = jacobi(i - 1, i) = i / std::sqrt(4.0 * i * i - 1);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(jacobi);
  return {(eigen.eigenvalues().array() + 1) / 2, eigen.eigenvectors().row(0).array().square()};
}

struct ReferencePoint {
  Eigen::Vector4d barycentric;
  double weight;  ///< the weights of a rule add up to 1
};

std::vector<ReferencePoint> collapsedRule() {
  const auto [place, weight] = gaussLegendre(5);
  std::vector<ReferencePoint> points;
  for (int i = 0; i < place.size(); ++i)
    for (int j = 0; j < place.size(); ++j)
      for (int k = 0; k < place.size(); ++k) {
        const double u = place[i], v = place[j], w = place[k];
        const double x = u, y = v * (1 - u), z = w * (1 - u) * (1 - v);
        const double jacobian = 6 * (1 - u) * (1 - u) * (1 - v);
        points.push_back({{1 - x - y - z, x, y, z}, jacobian * weight[i] * weight[j] * weight[k]});
      }
  return points;
}

/// Computes the shape functions and gradients of all nodes from those of the vertices.
void fillShapeFunctions(IntegrationPoint& point, const std::array<Eigen::Vector3d, 4>& gradients) {
  const auto& l = point.vertex_N;
  const bool quadratic = point.nodes == 10;
  for (int a = 0; a < 4; ++a) {
    point.N[a] = quadratic ? l[a] * (2 * l[a] - 1) : l[a];
    point.gradient[a] = (quadratic ? 4 * l[a] - 1 : 1.0) * gradients[a];
  }
  for (int e = 0; 4 + e < point.nodes; ++e) {
    const auto [a, b] = tetrahedron_edges[e];
    point.N[4 + e] = 4 * l[a] * l[b];
    point.gradient[4 + e] = 4 * (l[a] * gradients[b] + l[b] * gradients[a]);
  }
}

}  // namespace

void integrate(const Mesh& mesh, const std::function<void(const IntegrationPoint&)>& visit) {
  static const std::vector<ReferencePoint> rule = collapsedRule();
  PALPATE_ASSERT(mesh.edges.empty() || mesh.mid_edge_nodes.size() == mesh.tetrahedra.size(),
                 "elements of a quadratic mesh need mid-edge nodes");
  IntegrationPoint point;
  point.nodes = mesh.edges.empty() ? 4 : 10;
  for (std::size_t element = 0; element < mesh.tetrahedra.size(); ++element) {
    const Tetrahedron& tetrahedron = mesh.tetrahedra[element];
    Eigen::Matrix3d edges;
    for (int a = 0; a < 3; ++a)
      edges.row(a) = mesh.nodes[tetrahedron[a + 1]] - mesh.nodes[tetrahedron[0]];
    const Eigen::Matrix3d inverse = edges.inverse();
    const std::array<Eigen::Vector3d, 4> gradients = {-inverse.rowwise().sum(), inverse.col(0),
                                                      inverse.col(1), inverse.col(2)};
    for (int a = 0; a < 4; ++a) point.node[a] = tetrahedron[a];
    for (int e = 0; 4 + e < point.nodes; ++e) point.node[4 + e] = mesh.mid_edge_nodes[element][e];
    for (const ReferencePoint& reference : rule) {
      point.weight = reference.weight * sixVolume(mesh, element) / 6;
      point.X.setZero();
      for (int a = 0; a < 4; ++a) {
        point.vertex_N[a] = reference.barycentric[a];
        point.X += reference.barycentric[a] * mesh.nodes[tetrahedron[a]];
      }
      fillShapeFunctions(point, gradients);
      visit(point);
    }
  }
}

}  // namespace palpate::verification
