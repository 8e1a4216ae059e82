#include "viewer/devices/virtual_hand.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

const DeviceProfile& touchProfile() { return device_profiles.front(); }

HandPath resting() { return HandPath({{0, {0.01, 0.02, 0.03}}}); }

TEST(VirtualHand, BeginsAtTheStartOfItsPath) {
  VirtualHand hand(resting(), 1e-3, touchProfile());
  const DeviceReading reading = hand.read();
  EXPECT_EQ(reading.position, Eigen::Vector3d(0.01, 0.02, 0.03));
  EXPECT_EQ(reading.status, DeviceStatus::fresh);
  EXPECT_TRUE(hand.livesInScene());
}

TEST(VirtualHand, YieldsToAConstantForceByForceOverStiffness) {
  VirtualHand hand(resting(), 1e-3, touchProfile());
  Eigen::Vector3d position;
  for (int i = 0; i < 2000; ++i) {
    position = hand.read().position;
    hand.write({0, 2, -1});
  }
  EXPECT_LT((position - Eigen::Vector3d(0.01, 0.025, 0.0275)).norm(), 1e-9);
}

/// The step response of the damped oscillator from its formula.
TEST(VirtualHand, SwingsAsItsMassSpringAndDamperDo) {
  constexpr int finer = 16;  // the formula is continuous in time
  constexpr double period = 1e-3 / finer;
  VirtualHand hand(HandPath({{0, {0, 0, 0}}}), period, touchProfile());
  const double decay = VirtualHand::damping / (2 * VirtualHand::mass);
  const double natural = std::sqrt(VirtualHand::stiffness / VirtualHand::mass);
  const double w = std::sqrt(natural * natural - decay * decay);
  hand.read();
  hand.write({1, 0, 0});
  for (int i = 1; i <= 300 * finer; ++i) {
    const double t = i * period;
    const double expected =
        1 / VirtualHand::stiffness *
        (1 - std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t)));
    EXPECT_NEAR(hand.read().position.x(), expected, 2e-6) << t;
    hand.write({1, 0, 0});
  }
}

TEST(VirtualHand, FollowsItsPathCloselyWithoutForce) {
  VirtualHand hand(
      HandPath({{0, {0, 0, 0}}, {1, {0.05, 0, 0}}, {2, {0, 0, 0}}}, HandPath::AtEnd::repeats), 1e-3,
      touchProfile());
  for (int i = 0; i < 5000; ++i)
    EXPECT_NEAR(hand.read().position.x(), hand.path().at(i * 1e-3).position.x(), 5e-4) << i;
}

TEST(VirtualHand, FeelsNothingWhileHalted) {
  VirtualHand pushed(resting(), 1e-3, touchProfile());
  const Eigen::Vector3d start = pushed.read().position;
  pushed.halt();
  for (int i = 0; i < 100; ++i) {
    pushed.write({3, 0, 0});
    EXPECT_EQ(pushed.read().position, start);
  }
  pushed.resume();
  pushed.write({3, 0, 0});
  EXPECT_GT(pushed.read().position.x(), start.x());
}

TEST(VirtualHand, RefusesPeriodsWithoutAStableMotion) {
  for (const double period : {0.0, -1e-3, 1.0, std::nan("")})
    test::expectBadInput([&] { VirtualHand(resting(), period, touchProfile()); },
                         {"period", "raise the rate"});
}

}  // namespace
}  // namespace palpate
