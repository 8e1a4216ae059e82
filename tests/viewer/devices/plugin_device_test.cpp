#include "viewer/devices/plugin_device.hpp"

#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/expect_error.hpp"
#include "tests/viewer/devices/polling.hpp"
#include "tests/viewer/devices/real_time_threads.hpp"
#include "tests/viewer/haptics/scripted_hand.hpp"
#include "viewer/haptics/haptic_loop.hpp"
#include "viewer/haptics/real_time.hpp"

namespace palpate {
namespace {

using test::eventually;
using test::expectBadInput;
using test::expectError;
using ::testing::HasSubstr;

PluginDeviceOptions circle(const std::string& id = "", const std::string& options = "") {
  return {CIRCLE_DEVICE, id, options, 1e-3};
}
PluginDeviceOptions broken(const std::string& fault) {
  return {std::filesystem::path(BROKEN_PLUGINS) / ("plugin_" + fault + ".so"), "", "", 1e-3};
}

TEST(PluginDevice, ListsItsDevicesIfTheRequestedOneIsMissing) {
  expectError(ExitCode::failed, [] { PluginDevice(circle("square")); },
              {"square", "devices found: circle"});
}

TEST(PluginDevice, ReportsTheLimitsOfItsDevice) {
  const PluginDevice device(circle("circle"));
  EXPECT_EQ(device.profile().max_force, 5);
  EXPECT_EQ(device.profile().max_stiffness, 1000);
  EXPECT_EQ(device.profile().workspace_radius, 0.06);
  EXPECT_FALSE(device.hasButtons());
  EXPECT_FALSE(device.livesInScene());
  EXPECT_THAT(device.name(), HasSubstr("circle"));
}

TEST(PluginDevice, MovesOnTheRequestedCircleAndYieldsToForce) {
  PluginDevice device(circle("", "radius=0.03"));
  ASSERT_TRUE(eventually([&] { return device.read().status == DeviceStatus::fresh; }));
  EXPECT_NEAR(device.read().position.norm(), 0.03, 1e-12);
  device.write({0, 0, 4});
  EXPECT_TRUE(eventually([&] { return std::abs(device.read().position.z() - 0.004) < 1e-12; }));
  device.halt();
  EXPECT_TRUE(eventually([&] { return device.read().position.z() == 0; }));
  device.resume();
  EXPECT_TRUE(eventually([&] { return std::abs(device.read().position.z() - 0.004) < 1e-12; }));
}

TEST(PluginDevice, HasARealTimeThreadOnRequest) {
  PluginDevice device(circle());
  EXPECT_EQ(test::threadsWith(device_priority), 0) << "unless requested";
  const std::string refused = device.askForRealTime();
  if (!refused.empty()) GTEST_SKIP() << refused;
  EXPECT_EQ(test::threadsWith(device_priority), 1);
}

TEST(PluginDevice, PassesOnWhyADeviceCannotBeOpened) {
  expectError(ExitCode::failed, [] { PluginDevice(circle("square")); },
              {"circle_device.so", "only \"circle\""});
  expectError(ExitCode::failed, [] { PluginDevice(circle("", "radius=7")); }, {"radius=METRES"});
}

TEST(PluginDevice, RefusesAFileThatIsNotAPlugInByName) {
  expectBadInput([] { PluginDevice({"nowhere.so"}); },
                 {"nowhere.so", "cannot be loaded", "No such file"});
  expectBadInput([] { PluginDevice({PALPATE_SOURCE_DIR "/README.md"}); },
                 {"README.md", "invalid ELF header"});
  expectBadInput([] { PluginDevice(broken("NO_ENTRY")); },
                 {"plugin_NO_ENTRY.so", "palpate_device_plugin_v1"});
  expectBadInput([] { PluginDevice(broken("OLD_ABI")); }, {"plugin_OLD_ABI.so", "version 2"});
  expectBadInput([] { PluginDevice(broken("SHORT_TABLE")); }, {"plugin_SHORT_TABLE.so", "bytes"});
  expectBadInput([] { PluginDevice(broken("NULL_ENTRY")); },
                 {"plugin_NULL_ENTRY.so", "null entry"});
}

TEST(PluginDevice, AHungPlugInIsLostAndDoesNotBlockItsUser) {
  PluginDevice device(broken("HANGS"));
  for (int tick = 0; tick < 100; ++tick) {
    EXPECT_EQ(device.read().status, DeviceStatus::lost);
    device.write({1, 0, 0});
  }
}

/// Queries the library of a loaded plug-in.
class LoadedPlugin {
 public:
  explicit LoadedPlugin(const std::filesystem::path& file)
      : library_(dlopen(file.c_str(), RTLD_NOW | RTLD_NOLOAD), dlclose) {}
  template <class Result>
  Result ask(const char* function) const {
    return reinterpret_cast<Result (*)()>(dlsym(library_.get(), function))();
  }

 private:
  std::unique_ptr<void, int (*)(void*)> library_;
};

TEST(PluginDevice, APlugInHungWhilePressingResumesFromZero) {
  const PluginDeviceOptions options = broken("HANGS_PRESSING");
  PluginDevice device(options);
  const LoadedPlugin plugin(options.library);
  const test::TouchedCube cube;
  TickOptions tick_options;
  tick_options.guard = guardFor({"omega", 12, 5000, 0.075}, tick_options.period);
  HapticTick tick({&cube.model()}, device, tick_options);
  LoopOptions loop_options;
  loop_options.watchdog = 30;  // the loop itself does not hang
  HapticLoop loop(tick, device, loop_options);
  loop.start();
  plugin.ask<void>("broken_device_start");
  ASSERT_TRUE(eventually([&] { return plugin.ask<int>("broken_device_hangs") != 0; }));
  EXPECT_GT(plugin.ask<double>("broken_device_force_at_hang"), 0.1);
  EXPECT_TRUE(eventually([&] { return plugin.ask<double>("broken_device_force") == 0; }));
  EXPECT_NE(plugin.ask<int>("broken_device_hangs"), 0);
  EXPECT_EQ(loop.statistics().halts, 0U);

  plugin.ask<void>("broken_device_release");
  EXPECT_TRUE(eventually([&] { return plugin.ask<int>("broken_device_is_halted") == 0; }));
  EXPECT_LT(plugin.ask<double>("broken_device_longest_resumed"), 0.05);
  loop.stop();
}

TEST(PluginDevice, SaysWhyTheDeviceIsLost) {
  PluginDevice device(broken("HANGS"));
  device.halt();
  EXPECT_TRUE(eventually([&] {
    return device.trouble().find("the cable is out") != std::string::npos;
  })) << device.trouble();
}

}  // namespace
}  // namespace palpate
