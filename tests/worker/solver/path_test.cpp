#include "worker/solver/path.hpp"

#include <gtest/gtest.h>

#include "tests/support/meshes.hpp"
#include "tests/support/problems.hpp"
#include "tests/worker/solver/start_at_rest.hpp"

namespace palpate {
namespace {

/// A single node of a soft body is pushed far along its side: the straight path ends at a limit
/// point.
class PathTest : public ::testing::Test {
 protected:
  PathTest()
      : problem_(test::clampedProblem(test::mooneyRivlinScene(), test::blobMesh(), {0.1, 0, 0})),
        solver_(problem_, chooseKernels()) {
    rest_ = test::startAtRest(solver_);
  }
  Eigen::Vector3d along(double fraction) const {
    return fraction * 0.15 * Eigen::Vector3d(-1, -1, 0).normalized();
  }

  Problem problem_;
  TransitionSolver solver_;
  Start rest_;
};

TEST_F(PathTest, ALimitPointIsNamedWhereThePathTurnsBack) {
  const Reached before = walk(solver_, rest_, along(5.0 / 6), 5);
  ASSERT_TRUE(before.outcome.converged());
  Reached failed = solver_.reach(*before.end, along(1));
  ASSERT_FALSE(failed.outcome.converged());
  const double reached = failed.outcome.failure().step_reached;
  solver_.explainByLimitPoint(*before.end, along(1), failed);
  const Failure& failure = failed.outcome.failure();
  ASSERT_EQ(failure.cause, Cause::limit_point) << describe(failure);
  EXPECT_GE(failure.step_reached, reached);
  EXPECT_LT(failure.step_reached, 1);
  EXPECT_NE(failure.negative_pivots, failure.expected_negative_pivots);

  // Just before the limit point the branch still exists, and the stiffness grows towards infinity.
  const double just_before = failure.step_reached - 0.01;
  const Reached near_limit = walk(solver_, *before.end, along(5.0 / 6 + just_before / 6), 4);
  ASSERT_TRUE(near_limit.outcome.converged());
  EXPECT_GT(near_limit.outcome.equilibrium().stiffness.norm(),
            1.25 * before.outcome.equilibrium().stiffness.norm());
}

TEST_F(PathTest, ADetourLeadsPastALimitPoint) {
  const Reached path = walk(solver_, rest_, along(1), 6);
  ASSERT_TRUE(path.outcome.converged()) << describe(path.outcome.failure());
  EXPECT_GE(path.detours, 1);
  EXPECT_GT(path.min_det_F, 0);
  EXPECT_EQ(path.end->state.displacement, along(1));
}

TEST_F(PathTest, AStraightPathNeedsNoDetour) {
  const Reached path = walk(solver_, rest_, {0, 0.06, 0.04}, 3);
  ASSERT_TRUE(path.outcome.converged());
  EXPECT_EQ(path.detours, 0);
  const Outcome direct = solver_.reach(rest_, {0, 0.06, 0.04}).outcome;
  ASSERT_TRUE(direct.converged());
  EXPECT_LT((path.outcome.equilibrium().force - direct.equilibrium().force).norm(),
            1e-8 * direct.equilibrium().force.norm());
}

TEST_F(PathTest, AFailureReportsItsShareOfTheWholePath) {
  Scene scene = test::youngScene(LawName::st_venant_kirchhoff, 0.49);
  const Problem problem = test::clampedProblem(scene, test::blobMesh(), {0.1, 0, 0});
  TransitionSolver solver(problem, chooseKernels());
  const Reached path = walk(solver, test::startAtRest(solver), {-0.19, 0, 0}, 2);
  ASSERT_FALSE(path.outcome.converged());
  EXPECT_GT(path.outcome.failure().step_reached, 0);
  EXPECT_LT(path.outcome.failure().step_reached, 1);
  EXPECT_GT(path.outcome.cost.factorizations, 0);
}

}  // namespace
}  // namespace palpate
