#include "viewer/export/det_f.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "common/mesh/tetrahedron.hpp"

namespace palpate {
namespace {

using Barycentric = Eigen::Vector4d;

/// Appends every permutation of the barycentric coordinates of `point` once.
void addOrders(Barycentric point, std::vector<Barycentric>& points) {
  std::ranges::sort(point);
  do points.push_back(point);
  while (std::ranges::next_permutation(point).found);
}

/// Returns the places of a quadratic tetrahedron at which det F is computed: quadrature points and
/// nodes.
const std::vector<Barycentric>& lookedAt() {
  static const std::vector<Barycentric> places = [] {
    const double root = std::sqrt(15.0);
    const double a = (7 + root) / 34, b = (7 - root) / 34, c = (5 - root) / 20;
    std::vector<Barycentric> points = {Barycentric::Constant(0.25)};
    for (const double near : {a, b}) addOrders({near, near, near, 1 - 3 * near}, points);
    addOrders({c, c, 0.5 - c, 0.5 - c}, points);
    addOrders({1, 0, 0, 0}, points);
    addOrders({0.5, 0.5, 0, 0}, points);
    return points;
  }();
  return places;
}

Eigen::Vector3d displacementOf(std::span<const float> displacement, std::int32_t node) {
  return Eigen::Map<const Eigen::Vector3f>(displacement.data() + 3 * at(node)).cast<double>();
}

double linearDetF(const Mesh& mesh, std::size_t element, std::span<const float> displacement) {
  const Tetrahedron& t = mesh.tetrahedra[element];
  const auto gradients = barycentricGradients(mesh, element);
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  for (std::size_t n = 0; n < 4; ++n)
    F += displacementOf(displacement, t[n]) *
         gradients.col(static_cast<Eigen::Index>(n)).transpose();
  return F.determinant();
}

double smallestDetF(const Mesh& mesh, std::size_t element, std::span<const float> displacement) {
  const Tetrahedron& t = mesh.tetrahedra[element];
  const auto gradients = barycentricGradients(mesh, element);
  Eigen::Matrix<double, 3, 4> at_vertices;
  Eigen::Matrix<double, 3, 6> at_edges;
  for (int n = 0; n < 4; ++n) at_vertices.col(n) = displacementOf(displacement, t[at(n)]);
  for (int e = 0; e < 6; ++e)
    at_edges.col(e) = displacementOf(displacement, mesh.mid_edge_nodes[element][at(e)]);
  double smallest = std::numeric_limits<double>::infinity();
  for (const Barycentric& x : lookedAt()) {
    // Derivatives of the displacement with respect to the barycentric coordinates x, from the
    // quadratic shape functions x_n (2 x_n - 1) and 4 x_i x_j.
    Eigen::Matrix<double, 3, 4> slopes;
    for (int n = 0; n < 4; ++n) slopes.col(n) = (4 * x[n] - 1) * at_vertices.col(n);
    for (int e = 0; e < 6; ++e) {
      const auto [i, j] = tetrahedron_edges[at(e)];
      slopes.col(i) += 4 * x[j] * at_edges.col(e);
      slopes.col(j) += 4 * x[i] * at_edges.col(e);
    }
    const Eigen::Matrix3d F = Eigen::Matrix3d::Identity() + slopes * gradients.transpose();
    smallest = std::min(smallest, F.determinant());
  }
  return smallest;
}

}  // namespace

std::vector<float> detFOf(const Mesh& mesh, std::span<const float> displacement) {
  PALPATE_ASSERT(displacement.size() == 3 * mesh.nodes.size(), "det F needs all displacements");
  std::vector<float> values;
  for (std::size_t element = 0; element < mesh.tetrahedra.size(); ++element)
    values.push_back(static_cast<float>(mesh.mid_edge_nodes.empty()
                                            ? linearDetF(mesh, element, displacement)
                                            : smallestDetF(mesh, element, displacement)));
  return values;
}

}  // namespace palpate
