#include "worker/solver/critical_mode.hpp"

#include <gtest/gtest.h>

#include "tests/support/body_models.hpp"
#include "tests/support/meshes.hpp"
#include "tests/verification/rig.hpp"
#include "worker/elements/kernel_family.hpp"
#include "worker/solver/newton.hpp"

namespace palpate {
namespace {

/// A beam of 100 x 20 x 20 mm between two plates, kept straight although it would buckle.
class CriticalMode : public ::testing::Test {
 protected:
  CriticalMode() : system_(beam(), chooseKernels()), solver_(system_) {}

  static BodyModel beam() {
    BodyModel body =
        test::freeBody(test::beamMesh(), verification::taylor_hood, verification::neoHookean(3000));
    test::fix(body, "xmin");
    body.tools = {test::toolOf(body, "xmax")};
    return body;
  }
  NewtonResult pressed(double depth) {
    const Eigen::Vector3d way(-depth, 0, 0);
    State start = system_.restState();
    for (std::size_t node = 0; node < system_.model().mesh.nodes.size(); ++node)
      ofNode(start.u, node) = way * system_.model().mesh.nodes[node][0] / 0.1;
    const Eigen::VectorXd nothing =
        Eigen::VectorXd::Zero(system_.unknowns() + system_.multipliers());
    return findEquilibrium(system_, solver_, system_.moved(start, nothing, 1, way), way,
                           {.max_factorizations = 40});
  }

  System system_;
  TangentSolver solver_;
};

TEST_F(CriticalMode, IsTheEigenvectorOfTheMostNegativeEigenvalue) {
  const NewtonResult straight = pressed(0.025);
  ASSERT_EQ(straight.cause, Cause::none);
  const auto mode = criticalMode(system_, solver_, straight.state);
  ASSERT_TRUE(mode.has_value());
  Residual residual;
  Tangent tangent;
  system_.assemble(straight.state, residual, tangent);
  Eigen::VectorXd product = Eigen::VectorXd::Zero(system_.unknowns());
  const SparsityPattern& pattern = system_.pattern();
  for (std::size_t entry = 0; entry < tangent.values.size(); ++entry) {
    const int row = pattern.row[entry] - 1, column = pattern.column[entry] - 1;
    product[row] += tangent.values[entry] * (*mode)[column];
    if (row != column) product[column] += tangent.values[entry] * (*mode)[row];
  }
  const Eigen::VectorXd force = system_.displacementsOf(product),
                        shape = system_.displacementsOf(*mode);
  const double eigenvalue = shape.dot(force) / shape.squaredNorm();
  EXPECT_LT(eigenvalue, 0);
  EXPECT_LT((force - eigenvalue * shape).norm(), 1e-2 * force.norm());
  EXPECT_NEAR(shape.maxCoeff(), 1, 1e-6);
  EXPECT_GE(shape.minCoeff(), -1 - 1e-5);
  EXPECT_EQ(mode, criticalMode(system_, solver_, straight.state)) << "the same every time";
}

TEST_F(CriticalMode, IsEmptyForAStableBody) {
  const NewtonResult stable = pressed(0.005);
  ASSERT_EQ(stable.cause, Cause::none);
  EXPECT_FALSE(criticalMode(system_, solver_, stable.state).has_value());
}

}  // namespace
}  // namespace palpate
