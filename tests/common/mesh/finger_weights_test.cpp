#include "common/mesh/finger_weights.hpp"

#include <gtest/gtest.h>

#include <map>
#include <numeric>

#include "tests/support/meshes.hpp"

namespace palpate {
namespace {

constexpr double fingertip = 0.03;

/// A finger's mean of nodal values, and its derivatives by the finger's position.
struct Mean {
  double value = 0;
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();
};

/// A field that is not a polynomial.
double fieldAt(const Eigen::Vector3d& x) { return std::sin(31 * x[0] + 17 * x[1]) + 9 * x[2]; }

class Fingers : public ::testing::TestWithParam<bool> {
 protected:
  Fingers() {
    if (GetParam()) addMidEdgeNodes(mesh);
  }
  Mean meanAt(const Eigen::Vector3d& center) const {
    const FingerWeights finger = fingerWeights(mesh, fixed, center, fingertip);
    Mean mean;
    for (std::size_t n = 0; n < finger.nodes.size(); ++n) {
      const double value = fieldAt(mesh.nodes[finger.nodes[n]]);
      mean.value += finger.weights[n] * value;
      mean.gradient += value * finger.gradients[n];
      mean.curvature += value * finger.curvatures[n];
    }
    return mean;
  }

  Mesh mesh = test::blobMesh(7);
  NodeSet fixed;
};

TEST_P(Fingers, GradientsAndCurvaturesAreTheDerivativesOfTheWeights) {
  // One of the fingers is beside fixed nodes, where fewer nodes share the weight.
  fixed = mesh.node_groups.at("xmin");
  const Eigen::Vector3d beside = mesh.nodes[fixed[fixed.size() / 2]] + Eigen::Vector3d(0.02, 0, 0);
  constexpr double h = 1e-6;
  for (const Eigen::Vector3d& center :
       {Eigen::Vector3d(0.101, 0.003, 0.002), Eigen::Vector3d(0.02, 0.01, 0.05), beside}) {
    const Mean here = meanAt(center);
    ASSERT_GT(here.gradient.norm(), 0);
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d e = h * Eigen::Vector3d::Unit(axis);
      const Mean up = meanAt(center + e), down = meanAt(center - e);
      EXPECT_NEAR((up.value - down.value) / (2 * h), here.gradient[axis],
                  1e-6 * here.gradient.norm());
      // The curvature jumps a little when the edge of the bump passes a quadrature point.
      EXPECT_LT(((up.gradient - down.gradient) / (2 * h) - here.curvature.col(axis)).norm(),
                1e-2 * here.curvature.norm());
    }
  }
}

TEST_P(Fingers, WeightsHaveTheSumOneWhereverTheFingerIs) {
  for (const double x : {0.09, 0.1, 0.11}) {
    const FingerWeights finger = fingerWeights(mesh, fixed, {x, 0.01, 0.03}, fingertip);
    EXPECT_NEAR(std::accumulate(finger.weights.begin(), finger.weights.end(), 0.0), 1, 1e-13);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& gradient : finger.gradients) sum += gradient;
    EXPECT_LT(sum.norm(), 1e-11 / fingertip);
    EXPECT_NEAR(finger.free_share, 1, 1e-12);
  }
}

TEST_P(Fingers, MeanDependsOnTheFieldAndNotOnTheMesh) {
  std::map<int, double> means;
  const Eigen::Vector3d center(0.1, 0.1, 0.2);
  for (const int cells : {16, 32}) {
    mesh = test::cubeMesh(0.2, cells);
    if (GetParam()) addMidEdgeNodes(mesh);
    means[cells] = meanAt(center).value;
  }
  EXPECT_NEAR(means[16], means[32], 0.02);
}

TEST_P(Fingers, LeaveOutFixedNodesAndReportTheirShare) {
  mesh = test::cubeMesh(0.2, 8);
  if (GetParam()) addMidEdgeNodes(mesh);
  fixed = mesh.node_groups.at("xmin");
  const FingerWeights on_the_edge = fingerWeights(mesh, fixed, {0, 0.1, 0.2}, fingertip);
  // One of the two faces is fixed, and so is the first row of nodes of the other.
  EXPECT_GT(on_the_edge.free_share, 0.1);
  EXPECT_LT(on_the_edge.free_share, 0.5);
  for (const std::int32_t node : on_the_edge.nodes) EXPECT_FALSE(contains(fixed, node));
  EXPECT_EQ(fingerWeights(mesh, allNodes(mesh), {0, 0.1, 0.2}, fingertip).free_share, 0);
}

TEST_P(Fingers, ReachNothingFarFromTheBody) {
  const FingerWeights finger = fingerWeights(mesh, fixed, {1, 1, 1}, fingertip);
  EXPECT_TRUE(finger.nodes.empty());
  EXPECT_EQ(finger.free_share, 0);
}

INSTANTIATE_TEST_SUITE_P(OnLinearAndQuadraticMeshes, Fingers, ::testing::Bool(),
                         [](const auto& kind) { return kind.param ? "P2" : "P1"; });

}  // namespace
}  // namespace palpate
