#include "worker/solver/follower.hpp"

#include <gtest/gtest.h>

#include "common/problem/finger.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/problems.hpp"
#include "tests/worker/solver/start_at_rest.hpp"

namespace palpate {
namespace {

constexpr double followed_radius = 0.06;

class FollowerTest : public ::testing::Test {
 protected:
  FollowerTest() {
    problem_ = test::fingeredBlob(followed_radius);
    hand_ = {.place = problem_.active[0].finger->center, .displacement = {-0.008, 0.012, 0.006}};
  }
  Equilibrium exactAt(const Expansion& expansion) {
    TransitionSolver solver(problem_, chooseKernels());
    solver.placeFinger("here", {expansion.place, followed_radius});
    return walk(solver, test::startAtRest(solver), expansion.displacement, 2).outcome.equilibrium();
  }

  Problem problem_;
  HandMotion hand_;
};

TEST_F(FollowerTest, FindsTheEquilibriaOfARestingHandAndOfAMovingOne) {
  Follower follower(problem_, chooseKernels(), followed_radius);
  Followed found = follower.follow(hand_);
  for (int n = 0; n < 4; ++n) {
    ASSERT_TRUE(found.converged()) << describe(found.failure());
    const Equilibrium exact = exactAt(found.expansion());
    EXPECT_LT((found.expansion().equilibrium.force - exact.force).norm(),
              1e-4 * exact.force.norm());
    hand_.place += Eigen::Vector3d(0, 0.003, 0.002);
    hand_.displacement += Eigen::Vector3d(-0.002, 0, 0.001);
    found = follower.follow(hand_);
  }
}

TEST_F(FollowerTest, AimsWhereTheHandGoes) {
  Follower follower(problem_, chooseKernels(), followed_radius);
  const Followed still = follower.follow(hand_);
  hand_.displacement_speed = {-0.1, 0, 0};
  const Followed moving = follower.follow(hand_);
  EXPECT_EQ(still.expansion().displacement, hand_.displacement);
  EXPECT_LT(moving.expansion().displacement[0], hand_.displacement[0]);
  EXPECT_GT(moving.expansion().displacement[0], hand_.displacement[0] - 0.1);
}

TEST_F(FollowerTest, BeginsFromRestAfterAJump) {
  Follower follower(problem_, chooseKernels(), followed_radius);
  ASSERT_TRUE(follower.follow(hand_).converged());
  hand_.place = fingerNear("test", problem_.mesh, {0.02, 0.1, -0.05}, followed_radius).center;
  hand_.displacement *= -0.5;
  const Followed jumped = follower.follow(hand_);
  ASSERT_TRUE(jumped.converged()) << describe(jumped.failure());
  const Equilibrium exact = exactAt(jumped.expansion());
  EXPECT_LT((jumped.expansion().equilibrium.force - exact.force).norm(), 1e-4 * exact.force.norm());
}

TEST_F(FollowerTest, SaysWhyThereIsNoEquilibriumAndGoesOn) {
  Follower follower(problem_, chooseKernels(), followed_radius);
  const Eigen::Vector3d pushed = hand_.displacement;
  hand_.displacement = {-0.6, 0, 0};  // through the body
  EXPECT_NE(follower.follow(hand_).failure().cause, Cause::none);
  hand_.displacement = pushed;
  EXPECT_TRUE(follower.follow(hand_).converged());
}

TEST_F(FollowerTest, RefusesAPlaceThatIsFixed) {
  Follower follower(problem_, chooseKernels(), followed_radius);
  hand_.place = problem_.mesh.nodes[static_cast<std::size_t>(problem_.fixed.front())];
  test::expectBadInput([&] { follower.follow(hand_); }, {"hand"});
}

}  // namespace
}  // namespace palpate
