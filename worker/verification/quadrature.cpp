#include "worker/verification/quadrature.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <vector>

namespace palpate::verification {
namespace {

struct Rule {
  Eigen::VectorXd points, weights;  ///< on [0, 1]
};

/// Golub and Welsch 1969: the points are the eigenvalues of the Jacobi matrix of the Legendre
/// polynomials.
Rule gaussLegendre(int n) {
  Eigen::MatrixXd jacobi = Eigen::MatrixXd::Zero(n, n);
  for (int i = 1; i < n; ++i) jacobi(i, i - 1) = jacobi(i - 1, i) = i / std::sqrt(4.0 * i * i - 1);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(jacobi);
  return {(eigen.eigenvalues().array() + 1) / 2, eigen.eigenvectors().row(0).array().square()};
}

struct ReferencePoint {
  Eigen::Vector4d barycentric;
  double weight;  ///< sum 1
};

std::vector<ReferencePoint> collapsedRule() {
  const Rule rule = gaussLegendre(5);
  std::vector<ReferencePoint> points;
  for (int i = 0; i < rule.points.size(); ++i)
    for (int j = 0; j < rule.points.size(); ++j)
      for (int k = 0; k < rule.points.size(); ++k) {
        const double u = rule.points[i], v = rule.points[j], w = rule.points[k];
        const double x = u, y = v * (1 - u), z = w * (1 - u) * (1 - v);
        const double jacobian = 6 * (1 - u) * (1 - u) * (1 - v);
        points.push_back({{1 - x - y - z, x, y, z},
                          jacobian * rule.weights[i] * rule.weights[j] * rule.weights[k]});
      }
  return points;
}

void fillLinear(IntegrationPoint& point, const std::array<Eigen::Vector3d, 4>& gradients) {
  point.nodes = 4;
  for (int a = 0; a < 4; ++a) {
    point.N[a] = point.vertex_N[a];
    point.gradient[a] = gradients[a];
  }
}

void fillQuadratic(IntegrationPoint& point, const std::array<Eigen::Vector3d, 4>& gradients) {
  const auto& l = point.vertex_N;
  point.nodes = 10;
  for (int a = 0; a < 4; ++a) {
    point.N[a] = l[a] * (2 * l[a] - 1);
    point.gradient[a] = (4 * l[a] - 1) * gradients[a];
  }
  for (int e = 0; e < 6; ++e) {
    const auto [a, b] = tetrahedron_edges[e];
    point.N[4 + e] = 4 * l[a] * l[b];
    point.gradient[4 + e] = 4 * (l[a] * gradients[b] + l[b] * gradients[a]);
  }
}

}  // namespace

void integrate(const Mesh& mesh, const std::function<void(const IntegrationPoint&)>& visit) {
  static const std::vector<ReferencePoint> rule = collapsedRule();
  const bool quadratic = !mesh.edges.empty();
  IntegrationPoint point;
  for (std::size_t element = 0; element < mesh.tetrahedra.size(); ++element) {
    const Tetrahedron& tetrahedron = mesh.tetrahedra[element];
    Eigen::Matrix3d edges;
    for (int a = 0; a < 3; ++a)
      edges.row(a) = mesh.nodes[tetrahedron[a + 1]] - mesh.nodes[tetrahedron[0]];
    const Eigen::Matrix3d inverse = edges.inverse();
    const std::array<Eigen::Vector3d, 4> gradients = {-inverse.rowwise().sum(), inverse.col(0),
                                                      inverse.col(1), inverse.col(2)};
    for (int a = 0; a < 4; ++a) point.node[a] = tetrahedron[a];
    for (int e = 0; quadratic && e < 6; ++e) point.node[4 + e] = mesh.mid_edge_nodes[element][e];
    for (const ReferencePoint& reference : rule) {
      point.weight = reference.weight * sixVolume(mesh, element) / 6;
      point.X.setZero();
      for (int a = 0; a < 4; ++a) {
        point.vertex_N[a] = reference.barycentric[a];
        point.X += reference.barycentric[a] * mesh.nodes[tetrahedron[a]];
      }
      if (quadratic)
        fillQuadratic(point, gradients);
      else
        fillLinear(point, gradients);
      visit(point);
    }
  }
}

}  // namespace palpate::verification
