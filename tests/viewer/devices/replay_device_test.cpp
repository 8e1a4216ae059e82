#include "viewer/devices/replay_device.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

using test::expectBadInput;

/// Three ticks at 1 kHz, the second one lost.
Recording threeTicks() {
  Recording recording;
  recording.rate = 1000;
  recording.readings = {{{0.1, 0, 0}, 0, DeviceStatus::fresh},
                        {{0.2, 0, 0}, 1, DeviceStatus::lost},
                        {{0.3, 0, 0}, 2, DeviceStatus::repeated}};
  recording.scene_frame = true;
  recording.profile = {"omega", 12, 5000, 0.075};
  return recording;
}

TEST(ReplayDevice, GivesTheRecordedReadingsTickByTick) {
  const Recording recording = threeTicks();
  ReplayDevice device(recording, 1e-3, "run.h5");
  for (const DeviceReading& recorded : recording.readings) {
    const DeviceReading reading = device.read();
    EXPECT_EQ(reading.position, recorded.position);
    EXPECT_EQ(reading.buttons, recorded.buttons);
    EXPECT_EQ(reading.status, recorded.status);
    device.write({1, 0, 0});
  }
}

TEST(ReplayDevice, IsLostAfterTheLastTickAndSaysSo) {
  ReplayDevice device(threeTicks(), 1e-3, "run.h5");
  for (int tick = 0; tick < 3; ++tick) {
    EXPECT_THAT(device.trouble(), ::testing::IsEmpty());
    device.read();
  }
  EXPECT_TRUE(device.ended());
  EXPECT_EQ(device.read().status, DeviceStatus::lost);
  EXPECT_THAT(device.trouble(),
              ::testing::AllOf(::testing::HasSubstr("run.h5"), ::testing::HasSubstr("ended")));
}

TEST(ReplayDevice, HasTheFrameAndTheLimitsOfTheRecordedDevice) {
  const ReplayDevice device(threeTicks(), 1e-3, "run.h5");
  EXPECT_TRUE(device.livesInScene());
  EXPECT_EQ(device.profile(), (DeviceProfile{"omega", 12, 5000, 0.075}));
}

TEST(ReplayDevice, RefusesAnotherRateAndAnEmptyRun) {
  expectBadInput([] { ReplayDevice(threeTicks(), 2e-4, "run.h5"); },
                 {"run.h5", "1000 Hz", "--rate 1000"});
  expectBadInput([] { ReplayDevice(Recording{}, 1e-3, "run.h5"); }, {"run.h5", "empty"});
}

}  // namespace
}  // namespace palpate
