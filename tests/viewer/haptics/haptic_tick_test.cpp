#include "viewer/haptics/haptic_tick.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "tests/viewer/haptics/scripted_hand.hpp"

namespace palpate {
namespace {

using test::fresh;
using test::ScriptedHand;

class HapticTickTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { cube = new test::TouchedCube; }
  static void TearDownTestSuite() { delete cube; }
  static const HapticModel& model() { return cube->model(); }
  static TickOptions options() {
    TickOptions options;
    options.guard = guardFor({"omega", 12, 5000, 0.075}, options.period);
    return options;
  }
  /// Over the middle of the top: above it, and `depth` below it.
  static DeviceReading above() { return fresh({0.05, 0.05, 0.105}); }
  static DeviceReading pressed(double depth) { return fresh({0.05, 0.05, 0.1 - depth}); }
  /// Goes down a quarter of a millimetre per tick, to 5 mm.
  static DeviceReading pressing(std::uint64_t tick) {
    return pressed(std::min(0.005, 2.5e-4 * static_cast<double>(tick) - 5e-4));
  }

  static inline test::TouchedCube* cube = nullptr;
};

TEST_F(HapticTickTest, PushesTheHandOutOfTheBody) {
  ScriptedHand hand(pressing);
  HapticTick tick({&model()}, hand, options());
  for (int n = 0; n < 200; ++n) tick.run();
  const HapticState& state = tick.state();
  EXPECT_EQ(state.tick, 200U);
  EXPECT_DOUBLE_EQ(state.time, 0.2);
  EXPECT_TRUE(state.touch.touching);
  EXPECT_GT(state.force.z(), 0.1);
  EXPECT_NEAR((state.force - state.touch.force).norm(), 0, 1e-9);
  EXPECT_EQ(hand.last_force, state.force);
  EXPECT_EQ(hand.forces.size(), 200U);
  EXPECT_EQ(state.tool, state.reading.position);
}

TEST_F(HapticTickTest, ReleasesWithoutAFaultWhenTheHandIsAway) {
  ScriptedHand hand([](std::uint64_t tick) {
    DeviceReading reading = pressing(tick);
    if (tick > 100) reading.status = DeviceStatus::away;
    return reading;
  });
  HapticTick tick({&model()}, hand, options());
  for (int n = 0; n < 100; ++n) tick.run();
  const double force = tick.state().force.norm();
  ASSERT_GT(force, 0.1);
  tick.run();
  EXPECT_FALSE(tick.state().touch.touching);
  EXPECT_GT(tick.state().force.norm(), 0.5 * force) << "no kick for the hand";
  for (int n = 0; n < 100; ++n) tick.run();
  EXPECT_EQ(tick.state().force.norm(), 0);
  EXPECT_EQ(tick.state().guards, 0U);
}

TEST_F(HapticTickTest, SlidesWithoutStepsOfTheForce) {
  ScriptedHand hand(test::pressingAndSliding());
  HapticTick tick({&model()}, hand, options());
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  double largest_force = 0, largest_step = 0;
  for (int n = 0; n < 5000; ++n) {
    const HapticState& state = tick.run();
    largest_force = std::max(largest_force, state.force.norm());
    largest_step = std::max(largest_step, (state.force - before).norm());
    before = state.force;
  }
  RecordProperty("largest_force_N", std::to_string(largest_force));
  RecordProperty("largest_step_N", std::to_string(largest_step));
  EXPECT_LE(largest_step, 0.01 * largest_force);
}

TEST_F(HapticTickTest, GivesNoForceToALostDeviceAndReturnsByARamp) {
  ScriptedHand hand([](std::uint64_t tick) {
    DeviceReading reading = tick > 150 ? above() : pressing(tick);
    if (tick > 250) reading = pressing(tick - 250);
    if (tick > 100 && tick <= 110) reading = {{std::nan(""), 1e300, 0}, 0, DeviceStatus::lost};
    return reading;
  });
  HapticTick tick({&model()}, hand, options());
  for (int n = 1; n <= 100; ++n) tick.run();
  EXPECT_GT(tick.state().force.norm(), 0.1);
  for (int n = 101; n <= 110; ++n) {
    const HapticState& state = tick.run();
    EXPECT_EQ(state.force, Eigen::Vector3d::Zero());
    EXPECT_TRUE(state.tool.allFinite());
    EXPECT_FALSE(state.touch.touching);
    EXPECT_TRUE((state.guards & static_cast<std::uint32_t>(Guarded::lost)) != 0);
  }
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  for (int n = 111; n <= 500; ++n) {
    const HapticState& state = tick.run();
    EXPECT_LE((state.force - before).norm(), 0.1) << n;
    before = state.force;
  }
  EXPECT_GT(before.norm(), 0.1);
}

TEST_F(HapticTickTest, GoesSmoothlyToZeroWhenADeviceSendsNaN) {
  ScriptedHand hand([](std::uint64_t tick) {
    return tick > 100 ? fresh({0, std::nan(""), 0}) : pressing(tick);
  });
  HapticTick tick({&model()}, hand, options());
  for (int n = 1; n <= 100; ++n) tick.run();
  Eigen::Vector3d before = tick.state().force;
  const double pressing_force = before.norm();
  for (int n = 101; n <= 200; ++n) {
    const HapticState& state = tick.run();
    ASSERT_TRUE(state.force.allFinite());
    EXPECT_TRUE(state.tool.allFinite());
    EXPECT_LE((state.force - before).norm(), 0.04 * pressing_force);
    before = state.force;
  }
  EXPECT_EQ(before, Eigen::Vector3d::Zero());
}

TEST_F(HapticTickTest, GivesZeroAfterAHungLoop) {
  ScriptedHand hand(pressing);
  HapticTick tick({&model()}, hand, options());
  for (int n = 0; n < 100; ++n) tick.run();
  EXPECT_EQ(tick.run(true).force, Eigen::Vector3d::Zero());
  EXPECT_LT(tick.run().force.norm(), 0.01);
  for (int n = 0; n < 60; ++n) tick.run();
  EXPECT_GT(tick.state().force.norm(), 0.1);
}

TEST_F(HapticTickTest, NeverPushesHarderThanTheDeviceCan) {
  ScriptedHand hand([](std::uint64_t tick) {
    return pressed(std::min(0.025, 1e-4 * static_cast<double>(tick) - 1e-3));
  });
  hand.limits.max_force = 0.3;
  HapticTick tick({&model()}, hand, options());
  EXPECT_EQ(tick.options().guard.max_force, 0.3);
  for (int n = 0; n < 400; ++n) tick.run();
  EXPECT_GT(tick.state().touch.force.norm(), 0.5);
  for (const Eigen::Vector3d& force : hand.forces) EXPECT_LE(force.norm(), 0.3);
  EXPECT_NEAR(hand.last_force.norm(), 0.3, 1e-9);
}

TEST_F(HapticTickTest, TurnsForcesBackIntoTheFrameOfTheDevice) {
  TickOptions mapped = options();
  mapped.map.rotation = Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()).matrix();
  mapped.map.scale = 2.5;
  mapped.map.origin = {0.05, 0.04, 0.1};
  ScriptedHand straight(pressing);
  ScriptedHand turned(
      [&mapped](std::uint64_t tick) {
        const Eigen::Vector3d x = pressing(tick).position - mapped.map.origin;
        return fresh(mapped.map.rotation.transpose() * x / mapped.map.scale);
      },
      false);
  HapticTick in_scene({&model()}, straight, options()), in_device({&model()}, turned, mapped);
  for (int n = 0; n < 100; ++n) {
    in_scene.run();
    in_device.run();
    EXPECT_NEAR((mapped.map.rotation * turned.last_force - straight.last_force).norm(), 0, 1e-6);
  }
  EXPECT_GT(straight.last_force.norm(), 0.1);
}

TEST_F(HapticTickTest, SwitchesTheMethodWhileTouchingWithoutAKick) {
  ScriptedHand hand([](std::uint64_t tick) {
    return pressed(std::min(0.0137, 1e-4 * static_cast<double>(tick) - 1e-3));
  });
  HapticTick tick({&model()}, hand, options());
  for (int n = 0; n < 300; ++n) tick.run();
  Eigen::Vector3d before = tick.state().force;
  const Eigen::Vector3d potential = before;
  double largest_step = 0;
  tick.obey({HapticCommand::Kind::use, 0, 1});
  for (int n = 0; n < 100; ++n) {
    const HapticState& state = tick.run();
    EXPECT_EQ(state.method, 1);
    largest_step = std::max(largest_step, (state.force - before).norm());
    before = state.force;
  }
  EXPECT_TRUE(tick.state().touch.touching);
  const double difference = (before - potential).norm();
  EXPECT_GT(difference, 0.01);
  // The ramp takes 50 ticks, and its steepest slope is 1.5 times its mean slope.
  EXPECT_LE(largest_step, 1.6 * difference / 50);
}

/// The touch that is still shown has a triangle and spaces of the earlier model.
TEST_F(HapticTickTest, ForgetsTheShownTouchWhenTheModelChanges) {
  ScriptedHand hand(pressing);
  HapticTick tick({&model(), &model()}, hand, options());
  for (int n = 0; n < 100; ++n) tick.run();
  ASSERT_TRUE(tick.state().touch.touching);
  tick.obey({HapticCommand::Kind::use, 1, 0});
  EXPECT_EQ(tick.state().model, 1);
  EXPECT_FALSE(tick.state().touch.touching);
  EXPECT_TRUE(tick.run().touch.touching);
}

TEST_F(HapticTickTest, ReplacesAModelWhileTouching) {
  const HapticModel newer(cube->dataset(), {.methods = {"potential"}});
  ScriptedHand hand(pressing);
  HapticTick tick({&model()}, hand, options());
  tick.obey({HapticCommand::Kind::use, 0, 1});
  for (int n = 0; n < 100; ++n) tick.run();
  tick.obey({.kind = HapticCommand::Kind::replace, .replacement = &newer});
  EXPECT_EQ(tick.run().method, 0) << "the newer model has no other method";
  EXPECT_TRUE(tick.state().touch.touching);
  tick.obey({HapticCommand::Kind::use, 0, 1});
  EXPECT_EQ(tick.run().method, 0) << "the old model is no longer there";
}

TEST_F(HapticTickTest, IgnoresCommandsForMissingModelsAndMethods) {
  ScriptedHand hand(pressing);
  HapticTick tick({&model()}, hand, options());
  for (const HapticCommand& command : {HapticCommand{HapticCommand::Kind::use, 1, 0},
                                       HapticCommand{HapticCommand::Kind::use, -1, 0},
                                       HapticCommand{HapticCommand::Kind::use, 0, 2},
                                       HapticCommand{HapticCommand::Kind::use, 0, -1}})
    tick.obey(command);
  EXPECT_EQ(tick.run().model, 0);
  EXPECT_EQ(tick.state().method, 0);
}

TEST_F(HapticTickTest, KeepsItsMethodIfTheOtherIsNotPreparedYet) {
  HapticModel half(cube->dataset(), {.prepare = false});
  half.prepare(0);
  ScriptedHand hand(pressing);
  HapticTick tick({&half}, hand, options());
  for (int n = 0; n < 100; ++n) tick.run();
  tick.obey({HapticCommand::Kind::use, 0, 1});
  EXPECT_EQ(tick.run().method, 0);
  half.prepare(1);
  tick.obey({HapticCommand::Kind::use, 0, 1});
  EXPECT_EQ(tick.run().method, 1);
}

TEST_F(HapticTickTest, EndsContactOnCommandByARamp) {
  ScriptedHand hand(pressing);
  HapticTick tick({&model()}, hand, options());
  for (int n = 0; n < 100; ++n) tick.run();
  const double force = tick.state().force.norm();
  tick.obey({HapticCommand::Kind::release, 0, 0});
  EXPECT_NEAR(tick.run().force.norm(), force, 0.04 * force);
  EXPECT_FALSE(tick.state().touch.touching);
  for (int n = 0; n < 60; ++n) tick.run();
  EXPECT_EQ(tick.state().force.norm(), 0);
}

TEST_F(HapticTickTest, LeavesASecondFingerAndLetsItGo) {
  LiveTouch live(0.02);
  TickOptions following = options();
  following.contact.live = &live;
  following.contact.live_model = &model();
  bool out = false;
  ScriptedHand hand([&](std::uint64_t tick) { return out ? above() : pressing(tick); });
  HapticTick tick({&model()}, hand, following);
  const HapticCommand leave = {HapticCommand::Kind::hold};
  tick.obey(leave);
  EXPECT_FALSE(tick.run().hold) << "nothing is touched";
  for (int n = 0; n < 100; ++n) tick.run();
  const Touch touch = tick.state().touch;
  ASSERT_TRUE(touch.touching);
  tick.obey(leave);
  tick.run();
  ASSERT_TRUE(tick.state().hold);
  EXPECT_EQ(tick.state().hold->place, touch.anchor_position);
  EXPECT_EQ(tick.state().hold->displacement, touch.displacement);
  EXPECT_FALSE(tick.state().touch.touching) << "the hand goes on as another finger";
  EXPECT_FALSE(tick.state().hold_force.force.allFinite());

  out = true;
  for (int n = 0; n < 100; ++n) tick.run();
  out = false;
  tick.run();
  ASSERT_TRUE(tick.state().touch.touching);
  EXPECT_EQ(live.hand().hold.value().place, touch.anchor_position) << "the live solver knows it";
  Expansion found;
  found.place = tick.state().touch.anchor_position;
  found.displacement = tick.state().touch.displacement;
  found.held.emplace().at = *tick.state().hold;
  found.held->force[2] = 0.7;
  live.answer(found);
  tick.run();
  EXPECT_NEAR(tick.state().hold_force.force.z(), 0.7, 1e-9);
  tick.obey({HapticCommand::Kind::release});
  EXPECT_TRUE(tick.run().hold) << "only the hand's contact ends";
  tick.obey(leave);
  EXPECT_FALSE(tick.run().hold);
  EXPECT_FALSE(live.hand().hold);
}

TEST_F(HapticTickTest, HoldsTheBodyTickByTick) {
  LiveTouch live(0.02);
  const std::vector<std::optional<Hold>> holds = {
      std::nullopt, Hold{{0.03, 0.05, 0.1}, {0, 0, -0.002}}, std::nullopt};
  TickOptions following = options();
  following.holds = holds;
  ScriptedHand hand(pressing);
  EXPECT_FALSE(HapticTick({&model()}, hand, following).run().hold) << "without a live solver";
  following.contact.live = &live;
  following.contact.live_model = &model();
  HapticTick tick({&model()}, hand, following);
  EXPECT_FALSE(tick.run().hold);
  EXPECT_EQ(tick.run().hold.value().place, holds[1]->place);
  for (int n = 0; n < 200; ++n) EXPECT_FALSE(tick.run().hold);
  ASSERT_TRUE(tick.state().touch.touching);
  tick.obey({HapticCommand::Kind::hold});
  EXPECT_FALSE(tick.run().hold) << "no command moves it";
}

TEST_F(HapticTickTest, NeedsAModel) {
  ScriptedHand hand(pressing);
  EXPECT_THROW(HapticTick({}, hand, options()), std::logic_error);
}

TEST_F(HapticTickTest, FitsTheWorkspaceOfADeviceToTheTouchableSurface) {
  ScriptedHand hand(pressing, false);
  const WorkspaceMap map = workspaceFor(model(), hand, hand.profile());
  EXPECT_GT(map.scale, 1);
  EXPECT_LT(map.scale, 2);
  EXPECT_TRUE(map.rotation.isIdentity());
  const TouchSurface& surface = model().surface();
  for (std::size_t v = 0; v < surface.vertices().size(); ++v) {
    if (surface.sharesOf(static_cast<std::int32_t>(v)).empty()) continue;
    const double reach =
        (surface.vertices()[v] - map.origin).norm() + model().spaces().front().lattice.radius();
    EXPECT_LE(reach / map.scale, hand.limits.workspace_radius * (1 + 1e-9));
  }
  hand.limits.workspace_radius = 10;
  EXPECT_EQ(workspaceFor(model(), hand, hand.profile()).scale, 1);
}

TEST_F(HapticTickTest, DoesNotMapDevicesThatUseTheScenesFrame) {
  const ScriptedHand hand(pressing);
  const WorkspaceMap map = workspaceFor(model(), hand, hand.profile());
  EXPECT_EQ(map.scale, 1);
  EXPECT_EQ(map.origin, Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace palpate
