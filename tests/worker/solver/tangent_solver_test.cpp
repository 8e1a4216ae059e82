#include "worker/solver/tangent_solver.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "tests/support/meshes.hpp"
#include "tests/support/problems.hpp"
#include "tests/worker/solver/dense_tangent.hpp"
#include "worker/elements/kernel_family.hpp"

namespace palpate {
namespace {

/// A body with a tool, its equations at two nearby states, and factors of the tangent at rest.
class TangentSolverTest : public ::testing::Test {
 protected:
  void touch(ToolKind kind) {
    Scene scene = test::mooneyRivlinScene();
    scene.fixed.groups = {"xmin"};
    scene.active = {
        {.name = "tip", .near = Eigen::Vector3d(0.1, 0, 0), .radius = 0.06, .tool = kind}};
    problem_ = resolve(scene, test::blobMesh());
    system_ = std::make_unique<System>(problem_, chooseKernels());
    solver_ = std::make_unique<TangentSolver>(*system_);
    tangentAt(0.0, at_rest_);
  }
  /// The tangent after a smooth motion of up to `amplitude` metres.
  void tangentAt(double amplitude, Tangent& tangent) {
    State state = system_->restState();
    for (std::size_t node = 0; node < problem_.mesh.nodes.size(); ++node)
      if (!std::binary_search(problem_.fixed.begin(), problem_.fixed.end(), static_cast<int>(node)))
        state.u[3 * node + 1] = amplitude * std::sin(20 * problem_.mesh.nodes[node].x());
    Residual residual;
    system_->assemble(state, residual, tangent);
  }
  Eigen::MatrixXd dense(const Tangent& tangent) const { return test::dense(*system_, tangent); }

  Problem problem_;
  std::unique_ptr<System> system_;
  std::unique_ptr<TangentSolver> solver_;
  Tangent at_rest_;
};

TEST_F(TangentSolverTest, SolvesAndCountsNegativePivotsWithAndWithoutABorder) {
  for (const ToolKind kind : {ToolKind::rigid, ToolKind::weighted_average}) {
    touch(kind);
    const Factorization factorization = solver_->factorize(at_rest_);
    ASSERT_TRUE(factorization.ok);
    const Eigen::MatrixXd K = dense(at_rest_);
    const Eigen::VectorXd eigenvalues =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K, Eigen::EigenvaluesOnly).eigenvalues();
    EXPECT_EQ(factorization.negative_pivots, (eigenvalues.array() < 0).count());
    EXPECT_EQ(factorization.negative_pivots, system_->expectedNegativePivots());

    const Eigen::MatrixXd right = -at_rest_.tool_coupling;
    Eigen::MatrixXd x = right;
    ASSERT_TRUE(solver_->solve(x));
    const Eigen::MatrixXd exact = K.partialPivLu().solve(right);
    EXPECT_LT((x - exact).norm(), 1e-3 * exact.norm()) << "single precision";
  }
}

TEST_F(TangentSolverTest, RefinesWithTheFactorsOfATangentNearby) {
  for (const ToolKind kind : {ToolKind::rigid, ToolKind::weighted_average}) {
    touch(kind);
    ASSERT_TRUE(solver_->factorize(at_rest_).ok);
    Tangent nearby;
    tangentAt(0.0002, nearby);
    const Eigen::MatrixXd right = -nearby.tool_coupling;
    const auto refined = solver_->solveWith(nearby, right, 1e-9);
    ASSERT_TRUE(refined);
    const Eigen::MatrixXd exact = dense(nearby).partialPivLu().solve(right);
    EXPECT_LT((refined->solution - exact).norm(), 1e-6 * exact.norm());
    EXPECT_LT((refined->residual - (dense(nearby) * refined->solution - right)).norm(),
              1e-12 * right.norm());
  }
}

TEST_F(TangentSolverTest, ReportsFactorsThatAreTooFarAway) {
  touch(ToolKind::rigid);
  ASSERT_TRUE(solver_->factorize(at_rest_).ok);
  Tangent far_away;
  tangentAt(0.03, far_away);
  EXPECT_FALSE(solver_->solveWith(far_away, -far_away.tool_coupling, 1e-12));
}

}  // namespace
}  // namespace palpate
