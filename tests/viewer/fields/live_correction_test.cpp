#include "viewer/fields/live_correction.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr double radius = 0.02;
const Eigen::Vector3d place(0.01, 0.02, 0), pressed(0, 0, -0.01);

/// A spring of the place and the displacement, as an area and as an expansion.
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
  LiveCorrection live_{radius};
  double share_ = 0;
};

TEST_F(LiveCorrectionTest, LeavesTheAreaAsItIsWithoutExpansions) {
  EXPECT_EQ(at(place, pressed).force, springAt(100, place, pressed).force);
  EXPECT_EQ(share_, 0);
}

TEST_F(LiveCorrectionTest, TakesTheForceOfTheExpansionsNearTheHandAndOfTheAreaFarAway) {
  follow(150, place, pressed);
  EXPECT_NEAR(at(place, pressed).force[2], 1.5, 1e-3);
  EXPECT_GT(share_, 0.999);
  EXPECT_LT(at(place, pressed).error_bound, 0.01);
  const Eigen::Vector3d away = place + Eigen::Vector3d(1.1 * radius, 0, 0);
  EXPECT_EQ(at(away, pressed).force, springAt(100, away, pressed).force);
  EXPECT_EQ(share_, 0);
}

TEST_F(LiveCorrectionTest, IsOneEnergyAlsoWhereExpansionsDisagree) {
  follow(150, place, pressed);
  follow(140, place + Eigen::Vector3d(0.004, 0, 0), pressed + Eigen::Vector3d(0, 0.002, -0.003));
  constexpr double h = 1e-7;
  for (const double x : {0.002, 0.008, 0.014, 0.018}) {
    const Eigen::Vector3d s = place + Eigen::Vector3d(x, 0.001, 0),
                          p = pressed + Eigen::Vector3d(0.001, 0, -0.002);
    const AreaSample here = at(s, p);
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d e = h * Eigen::Vector3d::Unit(i);
      EXPECT_NEAR((at(s, p + e).energy - at(s, p - e).energy) / (2 * h), -here.force[i], 1e-6);
      EXPECT_NEAR((at(s + e, p).energy - at(s - e, p).energy) / (2 * h), -here.drive[i], 1e-6);
    }
  }
}

TEST_F(LiveCorrectionTest, FadesANewExpansionInWithoutAStep) {
  follow(150, place, pressed);
  Eigen::Vector3d before = at(place, pressed).force;
  live_.add(expansionOf(130, place, pressed), 0.03);
  for (int tick = 0; tick < 30; ++tick) {
    live_.advance(1e-3);
    const Eigen::Vector3d now = at(place, pressed).force;
    EXPECT_LT((now - before).norm(), 0.02) << tick;
    before = now;
  }
  EXPECT_NEAR(before[2], 1.4, 1e-3) << "both count as much";
}

TEST_F(LiveCorrectionTest, ForgetsOldExpansions) {
  follow(150, place, pressed);
  for (int n = 0; n < 2; ++n) follow(130, place, pressed);
  EXPECT_NEAR(at(place, pressed).force[2], 1.3, 1e-3);
}

TEST_F(LiveCorrectionTest, FadesOutWhenTheHandIsReleased) {
  follow(150, place, pressed);
  live_.release();
  live_.advance(LiveCorrection::release_time / 2);
  EXPECT_GT(at(place, pressed).force[2], springAt(100, place, pressed).force[2]);
  live_.advance(LiveCorrection::release_time);
  EXPECT_EQ(at(place, pressed).force, springAt(100, place, pressed).force);
}

TEST_F(LiveCorrectionTest, DoubtsExpansionsThatDisagree) {
  follow(150, place, pressed);
  const double alone = at(place, pressed).error_bound;
  follow(130, place, pressed);
  EXPECT_GT(at(place, pressed).error_bound, alone + 0.05);
}

TEST_F(LiveCorrectionTest, IsInsideBeyondTheEdgeOfTheArea) {
  follow(150, place, pressed);
  AreaSample beyond = springAt(100, place, pressed);
  beyond.inside = false;
  beyond.beyond = 0.003;
  beyond.coverage = 0;
  live_.correct(place, pressed, beyond);
  EXPECT_TRUE(beyond.inside);
  EXPECT_EQ(beyond.beyond, 0);
}

}  // namespace
}  // namespace palpate
