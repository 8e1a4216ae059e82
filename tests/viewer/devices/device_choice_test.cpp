#include "viewer/devices/device_choice.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "tests/support/command.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/support/sample_dataset.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/viewer/devices/tray_device.hpp"
#include "viewer/devices/device_command.hpp"
#include "viewer/devices/device_server.hpp"
#include "viewer/devices/touch_path.hpp"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate {
namespace {

using test::expectBadInput;
using ::testing::HasSubstr;

TEST(DeviceLimits, AreTheSmallerOfTwo) {
  const DeviceProfile device = {"plugin", 3300, 400, 60}, scene = {"falcon", 8, 3000, 0.04};
  EXPECT_EQ(smallerOf(device, scene), (DeviceProfile{"plugin", 8, 400, 0.04}));
}

TEST(DeviceLimits, WarnIfNoDeviceHasThem) {
  for (const DeviceProfile& known : device_profiles) EXPECT_EQ(doubtsOf(known), "");
  EXPECT_THAT(doubtsOf({"plugin", 3300, 400, 0.1}), HasSubstr("3300 N"));
  EXPECT_THAT(doubtsOf({"plugin", 3.3, 400, 60}), HasSubstr("60 m"));
  EXPECT_THAT(doubtsOf({"plugin", 3.3, 400, 0.001}), HasSubstr("0.001 m"));
}

/// A model of the sample dataset, a cube with two active nodes.
class DeviceChoice : public ::testing::Test {
 protected:
  DeviceChoice() { sample.seal(directory / "sample.h5"); }
  const HapticModel& model() {
    if (!model_) model_ = std::make_unique<HapticModel>(Dataset(directory / "sample.h5"));
    return *model_;
  }
  DeviceContext context() { return {&model(), 1e-3, device_profiles[2]}; }

  test::TemporaryDirectory directory;
  test::SampleDataset sample;

 private:
  std::unique_ptr<HapticModel> model_;
};

/// Regression: `palpate device` offered the mouse, but refused it.
TEST(LentDevices, ExcludeDevicesThatNeedABody) {
  EXPECT_THAT(deviceHelp(false),
              ::testing::AllOf(HasSubstr("virtual:FILE"), ::testing::Not(HasSubstr("mouse")),
                               ::testing::Not(HasSubstr("virtual,"))));
  EXPECT_THAT(deviceHelp(true), ::testing::AllOf(HasSubstr("mouse"), HasSubstr("virtual,")));
  expectBadInput([] { openDevice("falcon", {}); }, {deviceHelp(false)});
}

TEST_F(DeviceChoice, TheDefaultIsAVirtualHandOutsideOfTheBody) {
  const auto device = openDevice(default_device, context());
  EXPECT_EQ(device->name(), "virtual hand");
  EXPECT_EQ(device->profile(), device_profiles[2]);
  const NearestPoint nearest = model().surface().tree().nearest(device->read().position);
  EXPECT_TRUE(nearest.outside);
  EXPECT_GT(nearest.distance, 0.01);
}

TEST_F(DeviceChoice, TheDefaultPathPressesActiveNodesWithLimitedForce) {
  const HandPath path = touchPath(model());
  EXPECT_TRUE(path.repeats());
  for (std::size_t s = 0; s < model().spaces().size(); ++s) {
    double pressed = 0;
    for (const HandWaypoint& waypoint : path.waypoints()) {
      const NearestPoint nearest = model().surface().tree().nearest(waypoint.position);
      if (nearest.outside) continue;
      const SurfacePoint anchor{nearest.triangle, nearest.barycentric};
      if (!model().surface().touchable(anchor.triangle)) continue;
      const SpaceBlend blend = model().surface().blendAt(anchor);
      for (int i = 0; i < blend.size; ++i)
        if (blend.shares[static_cast<std::size_t>(i)].space == static_cast<int>(s))
          pressed = std::max(pressed, nearest.distance);
    }
    EXPECT_GT(pressed, 1e-4) << "space " << s;
    const auto vertex = static_cast<std::size_t>(model().surface().activeVertex(s));
    const Eigen::Vector3d normal = model().surface().vertexNormals()[vertex];
    double largest = 0;
    for (const HandWaypoint& waypoint : path.waypoints()) {
      const Eigen::Vector3d way = waypoint.position - model().surface().vertices()[vertex];
      if (way.dot(normal) < 0 && way.cross(normal).norm() < 1e-9)
        largest = std::max(largest, model().field(0, s).evaluate(way).force.norm());
    }
    EXPECT_GT(largest, 0);
    EXPECT_LE(largest, 1.5);
  }
}

/// Vertices of the ring around an active node may belong to its space alone, too; a hand there
/// would miss the touchable part.
TEST_F(DeviceChoice, TheDefaultPathComesDownOnTheActiveNodesThemselves) {
  const HandPath path = touchPath(model());
  for (std::size_t s = 0; s < model().spaces().size(); ++s) {
    const Eigen::Vector3d node =
        sample.problem.mesh.nodes[static_cast<std::size_t>(sample.problem.active[s].node)];
    const auto meets = [&](const HandWaypoint& waypoint) {
      return (waypoint.position - node).norm() < 1e-12;
    };
    EXPECT_TRUE(std::any_of(path.waypoints().begin(), path.waypoints().end(), meets))
        << "space " << s;
  }
}

TEST_F(DeviceChoice, TheDefaultPathSlidesOverAllSitesOfAFinger) {
  test::FingerBody().seal(directory / "body.h5");
  const HapticModel body(Dataset(directory / "body.h5"), {.methods = {"potential"}});
  const HandPath path = touchPath(body);
  EXPECT_TRUE(path.repeats());
  for (std::size_t s = 0; s < body.spaces().size(); ++s) {
    const Eigen::Vector3d site = body.spaces()[s].patch.finger->center;
    double nearest = 1;
    for (const HandWaypoint& waypoint : path.waypoints())
      if (!body.surface().tree().nearest(waypoint.position).outside)
        nearest = std::min(nearest, (waypoint.position - site).norm());
    EXPECT_LT(nearest, 0.012) << "pressed in at site " << s;
  }
  for (double time = 0; time < path.duration(); time += 0.01) {
    const HandTarget target = path.at(time);
    if (body.surface().tree().nearest(target.position).outside) continue;
    EXPECT_LT(target.velocity.norm(), 0.3);
  }
}

TEST_F(DeviceChoice, TheDefaultPathPressesAFingerOutsideAnArea) {
  test::FingerBody one;
  one.spaces.resize(1);
  one.problem.active.resize(1);
  one.problem.scene.active.resize(1);
  one.problem.scene.active[0].area.clear();
  one.seal(directory / "one.h5");
  const HapticModel body(Dataset(directory / "one.h5"), {.methods = {"potential"}});
  ASSERT_TRUE(body.surface().areas().empty());
  const HandPath path = touchPath(body);
  int inside = 0;
  for (const HandWaypoint& waypoint : path.waypoints())
    inside += body.surface().tree().nearest(waypoint.position).outside ? 0 : 1;
  EXPECT_GT(inside, 10) << "it presses, and circles";
}

TEST_F(DeviceChoice, OpensEachKindByItsName) {
  std::ofstream(directory / "hand.txt") << "0 0 0 0\n1 0 0 0.01\n";
  EXPECT_EQ(openDevice("virtual:" + (directory / "hand.txt").string(), {})->name(), "virtual hand");
  EXPECT_EQ(openDevice("mouse", context())->name(), "mouse");
  EXPECT_THAT(openDevice("haply:049D", {})->name(), HasSubstr("049D"));
  EXPECT_THAT(
      openDevice(std::string("plugin:") + CIRCLE_DEVICE + ":circle:radius=0.01", {})->name(),
      HasSubstr("circle"));
  test::TrayDevice tray;
  const KeyFolder keys(directory / "keys");
  const DeviceServer server(tray, "tcp://127.0.0.1:*", 1000, keys);
  EXPECT_THAT(openDevice(server.endpoint(), {.keys = {.folder = keys.path()}})->name(),
              HasSubstr("tray"));
  const DeviceServer open(tray, "tcp://127.0.0.1:*");
  EXPECT_THAT(openDevice(open.endpoint(), {.keys = {.insecure = true}})->name(), HasSubstr("tray"));
}

TEST(DeviceWord, UnknownWordsAreRefusedWithAListAndTheNearest) {
  expectBadInput(
      [] { openDevice("virtal", {}); },
      {"virtal", "did you mean virtual?", "replay:FILE", "tcp://HOST:PORT", "plugin:LIB.so"});
  expectBadInput([] { openDevice("", {}); }, {"--device", "replay:FILE"});
  expectBadInput([] { openDevice("mouse:3", {}); }, {"mouse:3"});
}

/// Programs check the word before they open anything else, for example a window, whose error would
/// hide that of the word.
TEST(DeviceWord, CanBeCheckedWithoutOpeningTheDevice) {
  for (const char* good : {"virtual", "mouse", "virtual:none.txt", "replay:none.h5", "haply",
                           "plugin:none.so", "tcp://127.0.0.1:1"})
    EXPECT_NO_THROW(checkDeviceWord(good)) << good;
  expectBadInput([] { checkDeviceWord("falcon"); }, {"--device falcon", "--profile falcon"});
  expectBadInput([] { checkDeviceWord("replay"); }, {"replay:FILE"});
  expectBadInput([] { checkDeviceWord("tcp://host"); }, {"tcp://host"});
}

TEST(DeviceWord, MissingPartsAreRequested) {
  expectBadInput([] { openDevice("virtual", {}); }, {"virtual:FILE"});
  expectBadInput([] { openDevice("mouse", {}); }, {"mouse"});
  expectBadInput([] { openDevice("replay", {}); }, {"replay:FILE"});
  expectBadInput([] { openDevice("replay:/nowhere.h5", {}); }, {"/nowhere.h5"});
  expectBadInput([] { openDevice("plugin:", {}); }, {"plugin:LIB.so"});
  expectBadInput([] { openDevice("tcp://host", {}); }, {"tcp://host"});
}

TEST(DeviceCommand, LendsADeviceUntilItIsInterrupted) {
  const test::TemporaryDirectory directory;
  const std::string log = (directory / "log").string();
  // The shell ignores SIGINT in the background; SIGTERM has the same meaning.
  const auto result = test::runCommand(
      "PALPATE_KEYS='" + (directory / "keys").string() +
      "' " PALPATE_BIN_DIR
      "/palpate-viewer device --listen 'tcp://127.0.0.1:*' --device plugin:" CIRCLE_DEVICE " > " +
      log + " 2>&1 & for i in $(seq 400); do grep -q 'is available at' " + log +
      " && break; sleep 0.05; done; kill -TERM $!; wait $!; code=$?; cat " + log + "; exit $code");
  EXPECT_THAT(result.output, HasSubstr("circle is available at tcp://127.0.0.1:"));
  EXPECT_EQ(result.exit_code, static_cast<int>(ExitCode::interrupted));
}

}  // namespace
}  // namespace palpate
