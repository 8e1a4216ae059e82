#include "viewer/haptics/live_touch.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr double period = 1e-3;

/// An equilibrium of 2 N at rest.
Expansion push() {
  Expansion expansion;
  expansion.equilibrium.force = {0, 0, 2};
  return expansion;
}

LiveHand touchingAt(double time, const Eigen::Vector3d& force = Eigen::Vector3d::Zero()) {
  LiveHand hand;
  hand.time = time;
  hand.touching = true;
  hand.force = force;
  return hand;
}

double forceOf(const LiveTouch& live) {
  AreaSample sample;
  sample.energy = 0;
  live.correct(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), sample);
  return sample.force[2];
}

void pass(LiveTouch& live, double seconds) {
  for (int n = 0; n < seconds / period; ++n) live.begin(period);
}

TEST(LiveTouch, GivesTheLoopTheNewestEquilibrium) {
  LiveTouch live(0.02);
  live.publish(touchingAt(0, {0, 0, 2}));
  live.answer(push());
  pass(live, LiveCorrection::release_time);
  EXPECT_NEAR(forceOf(live), 2, 1e-3);
}

TEST(LiveTouch, TakesAnEquilibriumOnce) {
  LiveTouch live(0.02);
  live.publish(touchingAt(0, {0, 0, 2}));
  live.answer(push());
  pass(live, LiveCorrection::release_time);
  live.publish({.time = 0.03});
  pass(live, LiveCorrection::release_time);
  EXPECT_EQ(forceOf(live), 0) << "it has faded out with the contact";
  live.publish(touchingAt(0.06));
  pass(live, LiveCorrection::release_time);
  EXPECT_EQ(forceOf(live), 0) << "and belongs to the contact before";
}

TEST(LiveTouch, IgnoresAnAnswerThatComesAfterTheContact) {
  LiveTouch live(0.02);
  live.publish({});
  live.answer(push());
  pass(live, LiveCorrection::release_time);
  EXPECT_EQ(forceOf(live), 0);
}

TEST(LiveTouch, ChangesTheForceByAFewMillinewtonsInATick) {
  LiveTouch live(0.02);
  live.publish({});
  live.publish(touchingAt(0));
  Expansion weak = push();
  weak.equilibrium.force[2] = 0.5;
  live.answer(weak);
  double before = 0;
  for (int tick = 0; tick < 300; ++tick) {
    if (tick % 50 == 49) live.answer(weak);
    live.begin(period);
    EXPECT_LT(forceOf(live) - before, 0.0055) << tick;
    before = forceOf(live);
  }
  EXPECT_NEAR(before, 0.5, 1e-3);
}

TEST(LiveTouch, ForgetsTheLastAnswersSmoothlyIfNoneFollow) {
  LiveTouch live(0.02);
  live.publish(touchingAt(0, {0, 0, 2}));
  live.answer(push());
  pass(live, 0.1);
  EXPECT_NEAR(forceOf(live), 2, 1e-3);
  double before = forceOf(live);
  for (int tick = 0; tick < 200; ++tick) {
    live.begin(period);
    EXPECT_LT(before - forceOf(live), 0.05) << tick;
    before = forceOf(live);
  }
  EXPECT_EQ(before, 0) << "the force of the area";
  live.answer(push());
  pass(live, 1);
  EXPECT_EQ(forceOf(live), 0) << "silent again";
  for (int n = 0; n < 4; ++n) {
    live.answer(push());
    pass(live, 0.1);
  }
  EXPECT_NEAR(forceOf(live), 2, 1e-3);
}

TEST(LiveTouch, WaitsLongerForASolverThatIsAlwaysSlow) {
  LiveTouch live(0.02);
  live.publish(touchingAt(0, {0, 0, 2}));
  pass(live, 0.3);
  live.answer(push());
  for (int n = 0; n < 4; ++n) {
    pass(live, 0.3);
    EXPECT_NEAR(forceOf(live), 2, 1e-3);
    live.answer(push());
  }
}

TEST(LiveTouch, ShowsTheHandToTheAskingThread) {
  LiveTouch live(0.02);
  live.publish({0.5, true, {1, 2, 3}, {4, 5, 6}});
  EXPECT_EQ(live.hand().time, 0.5);
  EXPECT_TRUE(live.hand().touching);
  EXPECT_EQ(live.hand().displacement, Eigen::Vector3d(4, 5, 6));
  EXPECT_FALSE(live.hand().hold);
  live.setHold(Hold{{7, 8, 9}, {1, 1, 1}});
  live.begin(0.001);
  live.publish({0.5, true, {1, 2, 3}, {4, 5, 6}});
  EXPECT_EQ(live.hand().hold.value().place, Eigen::Vector3d(7, 8, 9));
  EXPECT_FALSE(live.holdForce().force.allFinite()) << "nothing is known yet";
}

}  // namespace
}  // namespace palpate
