#include "viewer/export/det_f.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <random>

#include "common/base/index.hpp"
#include "common/mesh/tetrahedron.hpp"
#include "common/scene/formulation.hpp"
#include "tests/support/meshes.hpp"
#include "worker/elements/shape_functions.hpp"

namespace palpate {
namespace {

using kernels_default::degree_5_rule;
using kernels_default::P2;

Mesh boxOf(DisplacementSpace displacement) {
  Mesh mesh = test::distortedBoxMesh({0.1, 0.08, 0.06}, {2, 2, 2});
  if (displacement == DisplacementSpace::p2) addMidEdgeNodes(mesh);
  return mesh;
}

/// x y z of every node, metres, up to 4 mm.
std::vector<float> wildDisplacements(const Mesh& mesh) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> millimetres(-4e-3F, 4e-3F);
  std::vector<float> u(3 * mesh.nodes.size());
  std::ranges::generate(u, [&] { return millimetres(random); });
  return u;
}

TEST(DetF, IsTheDeterminantOfALinearMapEverywhere) {
  Eigen::Matrix3d F;
  F << 1.2, 0.1, 0, -0.3, 0.8, 0.05, 0, 0.2, 1.1;
  for (const DisplacementSpace space : {DisplacementSpace::p1, DisplacementSpace::p2}) {
    const Mesh mesh = boxOf(space);
    std::vector<float> u;
    for (const Eigen::Vector3d& x : mesh.nodes)
      for (const double component : F* x - x) u.push_back(static_cast<float>(component));
    const std::vector<float> found = detFOf(mesh, u);
    ASSERT_EQ(found.size(), mesh.tetrahedra.size());
    for (const float det_F : found) EXPECT_NEAR(det_F, F.determinant(), 2e-6);
  }
}

TEST(DetF, IsTheVolumeRatioOfALinearTetrahedron) {
  const Mesh mesh = boxOf(DisplacementSpace::p1);
  const std::vector<float> u = wildDisplacements(mesh);
  Mesh moved = mesh;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    moved.nodes[n] += Eigen::Map<const Eigen::Vector3f>(&u[3 * n]).cast<double>();
  const std::vector<float> found = detFOf(mesh, u);
  for (std::size_t e = 0; e < found.size(); ++e)
    EXPECT_NEAR(found[e], sixVolume(moved, e) / sixVolume(mesh, e), 1e-6);
}

/// det F of a quadratic element at a place, by the solver's own shape functions.
double solversDetF(const Mesh& mesh, std::size_t element, const std::vector<float>& u,
                   const double (&x)[4]) {
  const std::vector<std::int32_t> nodes = nodesOf(mesh, element);
  const Eigen::Matrix<double, 3, 4> gradients = barycentricGradients(mesh, element);
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  for (int a = 0; a < P2::nodes; ++a)
    for (int e = 0; e < P2::ends; ++e)
      F += P2::slope(a, e, x) *
           Eigen::Map<const Eigen::Vector3f>(&u[3 * at(nodes[at(a)])]).cast<double>() *
           gradients.col(P2::end[a][e]).transpose();
  return F.determinant();
}

/// As min_det_F of a configuration: at quadrature points and nodes.
TEST(DetF, IsTheSmallestAtTheSolversPointsOfAQuadraticElement) {
  const Mesh mesh = boxOf(DisplacementSpace::p2);
  const std::vector<float> u = wildDisplacements(mesh);
  const std::vector<float> found = detFOf(mesh, u);
  double spread = 0;
  for (std::size_t element = 0; element < found.size(); ++element) {
    double smallest = 1e9, largest = -1e9;
    const auto look = [&](const double(&x)[4]) {
      const double det_F = solversDetF(mesh, element, u, x);
      smallest = std::min(smallest, det_F);
      largest = std::max(largest, det_F);
    };
    for (const auto& x : degree_5_rule.point) look(x);
    for (const auto& ends : P2::end) {
      double x[4] = {};
      for (const int end : ends) x[end] += 0.5;
      look(x);
    }
    EXPECT_NEAR(found[element], smallest, 1e-6);
    spread = std::max(spread, largest - smallest);
  }
  EXPECT_GT(spread, 0.3) << "det F must vary within an element for this test";
}

}  // namespace
}  // namespace palpate
