#include "viewer/devices/mouse_device.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

struct MouseAtOrigin : MouseDevice {
  MouseAtOrigin() : MouseDevice(1e-3, device_profiles.front()) {
    moveTo({Eigen::Vector3d::Zero(), 1});
    read();
  }
};

/// x(t) = 1 - (1 + t/T) exp(-t/T)
TEST(MouseDevice, FollowsAStepAsACriticallyDampedSpring) {
  MouseAtOrigin mouse;
  mouse.moveTo({{1, 0, 0}, 1});
  for (int i = 1; i <= 200; ++i) {
    const double t = i * 1e-3 / 0.015;
    EXPECT_NEAR(mouse.read().position.x(), 1 - (1 + t) * std::exp(-t), 1e-12);
  }
}

TEST(MouseDevice, MakesOneSmoothMotionOfSixtyEventsASecond) {
  MouseAtOrigin mouse;
  const double step = 0.002;  // m per event: 0.12 m/s
  double last = 0, largest_change = 0, last_move = 0;
  for (int i = 0; i < 2000; ++i) {
    const int events = i / 16 + 1;
    if (i % 16 == 0) mouse.moveTo({{step * events, 0, 0}, 1});
    const double x = mouse.read().position.x();
    EXPECT_GE(x, last);
    if (i > 0) largest_change = std::max(largest_change, std::abs(x - last - last_move));
    last_move = x - last;
    last = x;
  }
  // The largest acceleration after a step is its length times rate^2.
  EXPECT_LT(largest_change, 1.05 * step / (0.015 * 0.015) * 1e-6);
}

TEST(MouseDevice, IsAwayWhileItHasNoPlace) {
  MouseDevice mouse(1e-3, device_profiles.front());
  EXPECT_EQ(mouse.read().status, DeviceStatus::away);
  mouse.moveTo({{0.1, 0, 0}, 1});
  mouse.read();
  EXPECT_EQ(mouse.read().status, DeviceStatus::fresh);
  EXPECT_EQ(mouse.read().position, Eigen::Vector3d(0.1, 0, 0));
  mouse.moveTo({{NAN, 0, 0}, 1});
  EXPECT_EQ(mouse.read().status, DeviceStatus::away);
}

TEST(MouseDevice, HasNoPositionBetweenTwoAppearances) {
  MouseAtOrigin mouse;
  mouse.moveTo({{1, 0, 0}, 2});
  EXPECT_EQ(mouse.read().status, DeviceStatus::away) << "nothing lies on its way";
  for (int n = 0; n < 3; ++n) {
    const DeviceReading reading = mouse.read();
    EXPECT_EQ(reading.status, DeviceStatus::fresh);
    EXPECT_EQ(reading.position, Eigen::Vector3d(1, 0, 0)) << "and it is at rest there";
  }
}

}  // namespace
}  // namespace palpate
