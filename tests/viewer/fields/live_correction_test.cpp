#include "viewer/fields/live_correction.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

constexpr double finger_radius = 0.02;
const Eigen::Vector3d touched_place(0.01, 0.02, 0), pressed_by(0, 0, -0.01);

/// A spring of the touched_place and the displacement, as an area and as an expansion.
AreaSample springAt(double stiffness, const Eigen::Vector3d& s, const Eigen::Vector3d& p) {
  AreaSample sample;
  sample.energy = 0.5 * stiffness * (p.squaredNorm() + 0.1 * s.squaredNorm());
  sample.force = -stiffness * p;
  sample.drive = -0.1 * stiffness * s;
  sample.stiffness = -stiffness * Eigen::Matrix3d::Identity();
  sample.error_bound = 0.1;
  sample.coverage = 1;
  sample.inside = true;
  return sample;
}
Expansion expansionOf(double stiffness, const Eigen::Vector3d& s, const Eigen::Vector3d& p) {
  const AreaSample sample = springAt(stiffness, s, p);
  Expansion expansion = {s, p, {}};
  Equilibrium& e = expansion.equilibrium;
  e.energy = sample.energy;
  e.force = sample.force;
  e.drive = sample.drive;
  e.stiffness = sample.stiffness;
  e.drive_slope = -0.1 * stiffness * Eigen::Matrix3d::Identity();
  return expansion;
}

class LiveCorrectionTest : public ::testing::Test {
 protected:
  AreaSample at(const Eigen::Vector3d& s, const Eigen::Vector3d& p) {
    AreaSample sample = springAt(100, s, p);
    share_ = live_.correct(s, p, sample);
    return sample;
  }
  void follow(double stiffness, const Eigen::Vector3d& s, const Eigen::Vector3d& p) {
    live_.add(expansionOf(stiffness, s, p), 0);
    live_.advance(1e-3);
  }
  LiveCorrection live_{finger_radius};
  double share_ = 0;
};

TEST_F(LiveCorrectionTest, LeavesTheAreaAsItIsWithoutExpansions) {
  EXPECT_EQ(at(touched_place, pressed_by).force, springAt(100, touched_place, pressed_by).force);
  EXPECT_EQ(share_, 0);
}

TEST_F(LiveCorrectionTest, TakesTheForceOfTheExpansionsNearTheHandAndOfTheAreaFarAway) {
  follow(150, touched_place, pressed_by);
  EXPECT_NEAR(at(touched_place, pressed_by).force[2], 1.5, 1e-3);
  EXPECT_GT(share_, 0.999);
  EXPECT_LT(at(touched_place, pressed_by).error_bound, 0.01);
  const Eigen::Vector3d away = touched_place + Eigen::Vector3d(1.1 * finger_radius, 0, 0);
  EXPECT_EQ(at(away, pressed_by).force, springAt(100, away, pressed_by).force);
  EXPECT_EQ(share_, 0);
}

TEST_F(LiveCorrectionTest, IsOneEnergyAlsoWhereExpansionsDisagree) {
  follow(150, touched_place, pressed_by);
  follow(140, touched_place + Eigen::Vector3d(0.004, 0, 0),
         pressed_by + Eigen::Vector3d(0, 0.002, -0.003));
  constexpr double h = 1e-7;
  for (const double x : {0.002, 0.008, 0.014, 0.018}) {
    const Eigen::Vector3d s = touched_place + Eigen::Vector3d(x, 0.001, 0),
                          p = pressed_by + Eigen::Vector3d(0.001, 0, -0.002);
    const AreaSample here = at(s, p);
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d e = h * Eigen::Vector3d::Unit(i);
      EXPECT_NEAR((at(s, p + e).energy - at(s, p - e).energy) / (2 * h), -here.force[i], 1e-6);
      EXPECT_NEAR((at(s + e, p).energy - at(s - e, p).energy) / (2 * h), -here.drive[i], 1e-6);
    }
  }
}

TEST_F(LiveCorrectionTest, FadesANewExpansionInWithoutAStep) {
  follow(150, touched_place, pressed_by);
  Eigen::Vector3d before = at(touched_place, pressed_by).force;
  live_.add(expansionOf(130, touched_place, pressed_by), 0.03);
  for (int tick = 0; tick < 30; ++tick) {
    live_.advance(1e-3);
    const Eigen::Vector3d now = at(touched_place, pressed_by).force;
    EXPECT_LT((now - before).norm(), 0.02) << tick;
    before = now;
  }
  EXPECT_NEAR(before[2], 1.4, 1e-3) << "both count as much";
}

TEST_F(LiveCorrectionTest, ForgetsOldExpansions) {
  follow(150, touched_place, pressed_by);
  for (int n = 0; n < 2; ++n) follow(130, touched_place, pressed_by);
  EXPECT_NEAR(at(touched_place, pressed_by).force[2], 1.3, 1e-3);
}

TEST_F(LiveCorrectionTest, FadesOutWhenTheHandIsReleased) {
  follow(150, touched_place, pressed_by);
  live_.release();
  live_.advance(LiveCorrection::release_time / 2);
  EXPECT_GT(at(touched_place, pressed_by).force[2],
            springAt(100, touched_place, pressed_by).force[2]);
  live_.advance(LiveCorrection::release_time);
  EXPECT_EQ(at(touched_place, pressed_by).force, springAt(100, touched_place, pressed_by).force);
}

/// A hold whose displacement adds 20 N/m to the force, and whose place adds 10 N/m.
Expansion heldAt(const Hold& hold) {
  Expansion expansion = expansionOf(150, touched_place, pressed_by);
  Held& held = expansion.held.emplace();
  held.at = hold;
  held.force[2] = 0.5;
  held.stiffness.diagonal() << -80, -80, -80, -40, -40, -40;
  held.hand_by_hold.topRows<3>() << 20 * Eigen::Matrix3d::Identity(),
      10 * Eigen::Matrix3d::Identity();
  return expansion;
}

TEST_F(LiveCorrectionTest, FollowsAHoldThatMovesAndSlides) {
  Hold hold = {{0.05, 0, 0}, {0, 0, 0.002}};
  live_.setHold(hold);
  live_.add(heldAt(hold), 0);
  live_.advance(1e-3);
  EXPECT_NEAR(at(touched_place, pressed_by).force[2], 1.5, 1e-3);
  EXPECT_NEAR(live_.holdForce(touched_place, pressed_by).force[2], 0.5, 1e-9);
  hold.displacement[2] += 0.004;
  live_.setHold(hold);
  EXPECT_NEAR(at(touched_place, pressed_by).force[2], 1.58, 2e-3);
  EXPECT_NEAR(live_.holdForce(touched_place, pressed_by).force[2], 0.5 - 80 * 0.004, 1e-9);
  for (int tick = 0; tick < 4; ++tick) {
    hold.place[0] += 0.001;
    live_.setHold(hold);
  }
  EXPECT_NEAR(at(touched_place, pressed_by).force[0], 0.04, 2e-3);
  EXPECT_LT(at(touched_place, pressed_by).error_bound, 1);
  for (int tick = 0; tick < 20; ++tick) {
    hold.place[0] += 0.001;
    live_.setHold(hold);
  }
  EXPECT_EQ(at(touched_place, pressed_by).force, springAt(100, touched_place, pressed_by).force)
      << "the expansion is too far away";
}

TEST(LiveCorrectionOfFibers, DoubtsEveryForce) {
  const auto bound = [](bool has_fibers) {
    LiveCorrection live(finger_radius, has_fibers);
    live.add(expansionOf(150, touched_place, pressed_by), 0);
    live.advance(1e-3);
    AreaSample sample = springAt(100, touched_place, pressed_by);
    live.correct(touched_place, pressed_by, sample);
    return sample.error_bound / sample.force.norm();
  };
  EXPECT_LT(bound(false), 0.001);
  EXPECT_NEAR(bound(true), 0.02, 0.001);
}

TEST_F(LiveCorrectionTest, ExtrapolatesNoHoldThatJumps) {
  Hold hold = {{0.05, 0, 0}, {0, 0, 0.002}};
  live_.setHold(hold);
  live_.add(heldAt(hold), 0);
  live_.advance(1e-3);
  hold.displacement[2] += 0.012;
  live_.setHold(hold);
  EXPECT_NEAR(at(touched_place, pressed_by).force[2], 1.5, 1e-3) << "without a step";
  EXPECT_GE(at(touched_place, pressed_by).error_bound, 1.49);
  EXPECT_FALSE(live_.holdForce(touched_place, pressed_by).force.allFinite());
  live_.add(heldAt(hold), 0);
  live_.advance(1e-3);
  EXPECT_LT(at(touched_place, pressed_by).error_bound, 0.01);
}

TEST_F(LiveCorrectionTest, BoundsTheErrorOfTheForceOnAHold) {
  Hold hold = {{0.05, 0, 0}, {0, 0, 0.002}};
  const auto bound = [&] { return live_.holdForce(touched_place, pressed_by).error_bound; };
  live_.setHold(hold);
  EXPECT_TRUE(std::isnan(bound())) << "no force, so no bound";
  live_.add(heldAt(hold), 0);
  EXPECT_NEAR(bound(), 0.5e-4, 1e-9) << "the solver's own error";
  hold.displacement[2] += 0.004;
  live_.setHold(hold);
  const double moved = bound();
  EXPECT_GT(moved, 0.1 * 80 * 0.004);
  Expansion other = heldAt(hold);
  other.held->force[2] = 0.1;
  live_.add(other, 0);
  EXPECT_GT(bound(), 1e-3) << "they disagree";
  EXPECT_LT(bound(), moved);
}

TEST_F(LiveCorrectionTest, ClaimsNoAccuracyOfTheAreaBesideAHold) {
  live_.setHold(Hold{{0.05, 0, 0}, {0, 0, 0.002}});
  const AreaSample alone = springAt(100, touched_place, pressed_by);
  EXPECT_EQ(at(touched_place, pressed_by).force, alone.force);
  EXPECT_GE(at(touched_place, pressed_by).error_bound, alone.force.norm());
}

TEST_F(LiveCorrectionTest, ClaimsNoAccuracyUntilTheLiveSolverKnowsTheHold) {
  follow(150, touched_place, pressed_by);
  EXPECT_LT(at(touched_place, pressed_by).error_bound, 0.01);
  const Hold hold = {{0.05, 0, 0}, {0, 0, 0.002}};
  live_.setHold(hold);
  EXPECT_NEAR(at(touched_place, pressed_by).force[2], 1.5, 1e-3) << "without a step";
  EXPECT_GE(at(touched_place, pressed_by).error_bound, 1.49);
  EXPECT_FALSE(live_.holdForce(touched_place, pressed_by).force.allFinite());
  live_.add(heldAt(hold), 0);
  live_.advance(1e-3);
  EXPECT_LT(at(touched_place, pressed_by).error_bound, 0.01);
  live_.setHold(std::nullopt);
  EXPECT_GE(at(touched_place, pressed_by).error_bound, 1.49);
}

TEST_F(LiveCorrectionTest, DoubtsExpansionsThatDisagree) {
  follow(150, touched_place, pressed_by);
  const double alone = at(touched_place, pressed_by).error_bound;
  follow(130, touched_place, pressed_by);
  EXPECT_GT(at(touched_place, pressed_by).error_bound, alone + 0.05);
}

TEST_F(LiveCorrectionTest, IsNotInsideWhereItsForceIsAGuess) {
  follow(150, touched_place, pressed_by);
  EXPECT_TRUE(at(touched_place, pressed_by).inside);
  follow(2, touched_place, pressed_by);
  EXPECT_GE(at(touched_place, pressed_by).error_bound, at(touched_place, pressed_by).force.norm());
  EXPECT_FALSE(at(touched_place, pressed_by).inside);
}

TEST_F(LiveCorrectionTest, BoundsTheErrorWhileAGuessFades) {
  live_.add(expansionOf(300, touched_place, pressed_by), 0.1);
  for (int tick = 0; tick < 100; ++tick) {
    live_.advance(1e-3);
    AreaSample guess = springAt(100, touched_place, pressed_by);
    guess.error_bound = guess.force.norm();
    live_.correct(touched_place, pressed_by, guess);
    EXPECT_LE((guess.force + 300 * pressed_by).norm(), guess.error_bound + 1e-3) << tick;
  }
}

TEST_F(LiveCorrectionTest, IgnoresThirdDerivativesWhereTheStiffnessJumps) {
  Expansion jumping = expansionOf(150, touched_place, pressed_by);
  jumping.equilibrium.stiffness_by_p(5, 2) = 1e8;
  live_.add(jumping, 0);
  live_.advance(1e-3);
  const Eigen::Vector3d deeper = pressed_by - Eigen::Vector3d(0, 0, 0.001);
  EXPECT_NEAR(at(touched_place, deeper).force[2], 1.65, 0.01);
  EXPECT_GT(at(touched_place, deeper).error_bound, 0.05) << "a part of 0.15 N is a guess";
}

TEST_F(LiveCorrectionTest, IsInsideBeyondTheEdgeOfTheArea) {
  follow(150, touched_place, pressed_by);
  AreaSample beyond = springAt(100, touched_place, pressed_by);
  beyond.inside = false;
  beyond.beyond = 0.003;
  beyond.coverage = 0;
  live_.correct(touched_place, pressed_by, beyond);
  EXPECT_TRUE(beyond.inside);
  EXPECT_EQ(beyond.beyond, 0);
}

}  // namespace
}  // namespace palpate
