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

/// Two fingers on the body, far enough from each other to have different nodes.
class HeldBody : public FollowerTest {
 protected:
  struct Both {
    Equilibrium equilibrium;
    Held held;
  };
  /// Returns the equilibrium with the second finger moving while the first one holds.
  Both solve(const HandMotion& holding, const HandMotion& moving) {
    TransitionSolver solver(problem_, chooseKernels());
    solver.placeFinger("first", {holding.place, followed_radius});
    const Reached held = walk(solver, test::startAtRest(solver), holding.displacement, 2);
    Failure failure;
    const auto start = solver.hold(*held.end, {moving.place, followed_radius}, failure);
    EXPECT_TRUE(start) << describe(failure);
    const Reached reached = walk(solver, *start, moving.displacement, 2);
    EXPECT_TRUE(reached.outcome.converged()) << describe(reached.outcome.failure());
    return {reached.outcome.equilibrium(), *reached.held};
  }

  /// Returns force and drive of the moving finger.
  static Vector6d forcesOf(const Both& both) {
    Vector6d forces;
    forces << both.equilibrium.force, both.equilibrium.drive;
    return forces;
  }

  const HandMotion other_ = {
      .place = fingerNear("test", problem_.mesh, {0.02, 0.1, -0.05}, followed_radius).center,
      .displacement = {0.004, -0.011, 0.005}};
};

TEST_F(HeldBody, HasTheSameForcesWhicheverFingerHolds) {
  const Both a = solve(hand_, other_), b = solve(other_, hand_);
  EXPECT_NEAR(a.equilibrium.energy, b.equilibrium.energy, 1e-7 * a.equilibrium.energy);
  const double force = a.equilibrium.force.norm(), stiffness = a.equilibrium.stiffness.norm();
  EXPECT_LT((forcesOf(a) - b.held.force).norm(), 1e-7 * force);
  EXPECT_LT((a.held.force - forcesOf(b)).norm(), 1e-7 * force);
  Matrix6d own;
  own << a.equilibrium.stiffness, a.equilibrium.drive_stiffness.transpose(),
      a.equilibrium.drive_stiffness, a.equilibrium.drive_slope;
  EXPECT_LT((own - b.held.stiffness).norm(), 1e-4 * stiffness);
  EXPECT_LT((a.held.hand_by_hold - b.held.hand_by_hold.transpose()).norm(), 1e-4 * stiffness);
  EXPECT_GT(a.held.hand_by_hold.norm(), 1e-3 * stiffness) << "the fingers must feel each other";
}

TEST_F(HeldBody, HasTheDerivativesOfItsEnergyWithRespectToTheHold) {
  const Both here = solve(other_, hand_);
  const double step = 1e-4;
  for (int axis = 0; axis < 6; ++axis) {
    HandMotion up = other_, down = other_;
    (axis < 3 ? up.displacement : up.place)[axis % 3] += step;
    (axis < 3 ? down.displacement : down.place)[axis % 3] -= step;
    const Both above = solve(up, hand_), below = solve(down, hand_);
    const auto slope = [&](const Vector6d& high, const Vector6d& low) -> Vector6d {
      return (high - low) / (2 * step);
    };
    const double stiffness = here.held.stiffness.norm();
    EXPECT_NEAR((above.equilibrium.energy - below.equilibrium.energy) / (2 * step),
                -here.held.force[axis], 1e-4 * here.held.force.norm());
    EXPECT_LT((slope(above.held.force, below.held.force) - here.held.stiffness.col(axis)).norm(),
              1e-4 * stiffness);
    EXPECT_LT((slope(forcesOf(above), forcesOf(below)) - here.held.hand_by_hold.col(axis)).norm(),
              1e-4 * stiffness);
  }
}

TEST_F(HeldBody, IsFollowedWhileBothFingersMoveAndSlide) {
  Follower follower(problem_, chooseKernels(), followed_radius);
  hand_.hold = Hold{other_.place, other_.displacement};
  for (int n = 0; n < 3; ++n) {
    const Followed found = follower.follow(hand_);
    ASSERT_TRUE(found.converged()) << describe(found.failure());
    const Expansion& expansion = found.expansion();
    ASSERT_TRUE(expansion.held);
    const Hold& at = expansion.held->at;
    EXPECT_LT((at.place - hand_.hold->place).norm(), 0.003) << "the surface is near";
    const Both exact = solve({.place = at.place, .displacement = at.displacement},
                             {.place = expansion.place, .displacement = expansion.displacement});
    EXPECT_LT((expansion.equilibrium.force - exact.equilibrium.force).norm(),
              1e-4 * exact.equilibrium.force.norm());
    EXPECT_LT((expansion.held->force - exact.held.force).norm(), 1e-4 * exact.held.force.norm());
    hand_.place += Eigen::Vector3d(0, 0.003, 0.002);
    hand_.displacement += Eigen::Vector3d(-0.002, 0, 0.001);
    hand_.hold->displacement += Eigen::Vector3d(0.001, -0.002, 0);
    hand_.hold->place += Eigen::Vector3d(0.003, 0, 0.003);
  }
  hand_.hold.reset();
  const Followed alone = follower.follow(hand_);
  EXPECT_FALSE(alone.expansion().held);
  EXPECT_LT((alone.expansion().equilibrium.force - exactAt(alone.expansion()).force).norm(),
            1e-4 * alone.expansion().equilibrium.force.norm());
}

TEST_F(HeldBody, IsLetGoAlsoAfterAFailure) {
  Follower follower(problem_, chooseKernels(), followed_radius);
  ASSERT_TRUE(follower.follow(hand_).converged());
  HandMotion held = hand_;
  held.hold = Hold{other_.place, other_.displacement};
  held.displacement = {-0.6, 0, 0};  // through the body
  ASSERT_FALSE(follower.follow(held).converged());
  const Followed alone = follower.follow(hand_);
  ASSERT_TRUE(alone.converged()) << describe(alone.failure());
  EXPECT_FALSE(alone.expansion().held);
  EXPECT_LT((alone.expansion().equilibrium.force - exactAt(alone.expansion()).force).norm(),
            1e-4 * alone.expansion().equilibrium.force.norm());
}

TEST_F(FollowerTest, StopsBesideFixedNodesWhenTheHandGoesOn) {
  Follower follower(problem_, chooseKernels(), followed_radius);
  const FreeShare free_share(problem_.mesh, problem_.fixed, followed_radius);
  const Eigen::Vector3d fixed =
      problem_.mesh.nodes[static_cast<std::size_t>(problem_.fixed.front())];
  const auto follow = [&] {
    const Followed found = follower.follow(hand_);
    EXPECT_TRUE(found.converged()) << describe(found.failure());
    return found.expansion();
  };
  Eigen::Vector3d place = follow().place;
  for (int n = 0; n < 200 && !free_share.isBelow(least_free_share, hand_.place); ++n) {
    hand_.place += 0.003 * (fixed - hand_.place).normalized();
    hand_.place = fingerNear("test", problem_.mesh, hand_.place, followed_radius).center;
    place = follow().place;
  }
  ASSERT_TRUE(free_share.isBelow(least_free_share, hand_.place)) << "no finger can be there";
  EXPECT_FALSE(free_share.isBelow(least_free_share, place));
  EXPECT_LT((place - hand_.place).norm(), 0.003);
  hand_.place = fixed;
  EXPECT_LT((follow().place - place).norm(), 0.003) << "it stays at the limit";
}

TEST_F(FollowerTest, RefusesAPlaceThatIsFixed) {
  Follower follower(problem_, chooseKernels(), followed_radius);
  hand_.place = problem_.mesh.nodes[static_cast<std::size_t>(problem_.fixed.front())];
  test::expectBadInput([&] { follower.follow(hand_); }, {"hand"});
}

}  // namespace
}  // namespace palpate
