#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/scene/device_profile.hpp"
#include "tests/viewer/c_api/sample_file.hpp"
#include "viewer/haptics/force_guard.hpp"

namespace palpate {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;

#define EXPECT_INVALID(call, text)             \
  EXPECT_EQ((call), PALPATE_INVALID_ARGUMENT); \
  EXPECT_THAT(palpate_last_error(), HasSubstr(text))

/// A spring of a simulator's own, pushing along x.
palpate_touch pushing(double newtons) {
  auto touch = test::sized<palpate_touch>();
  touch.touching = 1;
  touch.force[0] = newtons;
  return touch;
}

palpate_guarded_force limit(palpate_guard* guard, const palpate_touch& touch,
                            std::uint32_t flags = PALPATE_READING_FRESH) {
  const double tool[3] = {0, 0, 0};
  auto force = test::sized<palpate_guarded_force>();
  EXPECT_EQ(palpate_guard_limit(guard, tool, &touch, flags, &force), PALPATE_OK)
      << palpate_last_error();
  return force;
}

/// Long enough for every ramp.
palpate_guarded_force settled(palpate_guard* guard, double newtons) {
  palpate_guarded_force force{};
  for (int tick = 0; tick < 200; ++tick) force = limit(guard, pushing(newtons));
  return force;
}

TEST(CGuard, KnowsTheDevices) {
  for (const DeviceProfile& profile : device_profiles) {
    const std::string name(profile.name);
    auto device = test::sized<palpate_profile>();
    ASSERT_EQ(palpate_device_profile(name.c_str(), &device), PALPATE_OK);
    EXPECT_EQ(device.name, name);
    EXPECT_EQ(device.max_force, profile.max_force);
    EXPECT_EQ(device.max_stiffness, profile.max_stiffness);
    EXPECT_EQ(device.workspace_radius, profile.workspace_radius);
  }
  auto device = test::sized<palpate_profile>();
  EXPECT_INVALID(palpate_device_profile("joystick", &device), "joystick");
  EXPECT_THAT(palpate_last_error(), HasSubstr("touch, omni"));
  EXPECT_INVALID(palpate_device_profile(nullptr, &device), "name is NULL");
}

TEST(CGuard, TakesItsLimitsFromADevice) {
  auto options = test::sized<palpate_guard_options>();
  ASSERT_EQ(palpate_guard_defaults("omega", 5e-4, &options), PALPATE_OK);
  EXPECT_EQ(options.period, 5e-4);
  EXPECT_EQ(options.max_force, 12);
  EXPECT_EQ(options.max_stiffness, 5000);
  EXPECT_EQ(options.max_slew, 0) << "follows max_force";
  EXPECT_EQ(options.delay, 0);
  ASSERT_EQ(palpate_guard_defaults(nullptr, 1e-3, &options), PALPATE_OK);
  EXPECT_EQ(options.max_force, 3.3);
  EXPECT_INVALID(palpate_guard_defaults("joystick", 1e-3, &options), "joystick");
  EXPECT_INVALID(palpate_guard_defaults("omega", 0, &options), "period is 0");
}

TEST(CGuard, TakesTheWholeForceIn10MillisecondsUnlessASlewIsGiven) {
  const double tool[3] = {};
  for (const double max_slew : {0.0, test::nan_value, 500.0}) {
    auto options = test::sized<palpate_guard_options>();
    ASSERT_EQ(palpate_guard_defaults("touch", 1e-3, &options), PALPATE_OK);
    options.max_force = 20;
    options.max_slew = max_slew;
    palpate_guard* guard = nullptr;
    ASSERT_EQ(palpate_guard_create(&options, &guard), PALPATE_OK);
    auto touch = test::sized<palpate_touch>();
    auto given = test::sized<palpate_guarded_force>();
    EXPECT_EQ(palpate_guard_limit(guard, tool, &touch, PALPATE_READING_FRESH, &given), PALPATE_OK);
    touch.touching = 1;
    touch.force[0] = 10;
    EXPECT_EQ(palpate_guard_limit(guard, tool, &touch, PALPATE_READING_FRESH, &given), PALPATE_OK);
    EXPECT_NEAR(given.force[0], max_slew > 0 ? 0.5 : 2, 1e-12) << max_slew;
    palpate_guard_destroy(guard);
  }
}

TEST(CGuard, ClampsToTheDevice) {
  const auto guard = test::guardWith();
  const palpate_guarded_force force = settled(guard.get(), 50);
  EXPECT_NEAR(force.force[0], 3.3, 1e-12);
  EXPECT_TRUE(force.guards & PALPATE_GUARD_CLAMPED) << force.guards;
}

TEST(CGuard, LimitsTheRate) {
  const auto guard = test::guardWith();
  settled(guard.get(), 0);
  double last = 0;
  std::uint32_t guards = 0;
  for (int tick = 0; tick < 100; ++tick) {
    const palpate_guarded_force force = limit(guard.get(), pushing(3));
    EXPECT_LE(std::abs(force.force[0] - last), 0.33 + 1e-12) << tick;
    last = force.force[0];
    guards |= force.guards;
  }
  EXPECT_NEAR(last, 3, 1e-9);
  EXPECT_TRUE(guards & PALPATE_GUARD_SLEWED) << guards;
}

TEST(CGuard, FadesStepsIn) {
  const auto guard = test::guardWith();
  palpate_touch touch = pushing(2);
  touch.stepped = 1;
  const palpate_guarded_force first = limit(guard.get(), touch);
  EXPECT_LT(first.force[0], 0.05);
  EXPECT_TRUE(first.guards & PALPATE_GUARD_RAMPED);
  EXPECT_NEAR(settled(guard.get(), 2).force[0], 2, 1e-9);
}

TEST(CGuard, GivesNothingForALostDeviceALateLoopOrNan) {
  const auto guard = test::guardWith();
  ASSERT_NEAR(settled(guard.get(), 2).force[0], 2, 1e-9);
  const palpate_guarded_force lost =
      limit(guard.get(), pushing(2), PALPATE_READING_FRESH | PALPATE_READING_LOST);
  EXPECT_THAT(lost.force, Each(0.0));
  EXPECT_TRUE(lost.guards & PALPATE_GUARD_LOST);

  ASSERT_NEAR(settled(guard.get(), 2).force[0], 2, 1e-9);
  const palpate_guarded_force late =
      limit(guard.get(), pushing(2), PALPATE_READING_FRESH | PALPATE_LOOP_LATE);
  EXPECT_THAT(late.force, Each(0.0));
  EXPECT_TRUE(late.guards & PALPATE_GUARD_LATE);

  const palpate_guarded_force bad = settled(guard.get(), test::nan_value);
  EXPECT_THAT(bad.force, Each(0.0));
  EXPECT_TRUE(bad.guards & PALPATE_GUARD_NOT_FINITE);
}

TEST(CGuard, GivesNothingToWhoNeverSaysThatAReadingIsFresh) {
  const auto guard = test::guardWith();
  palpate_guarded_force force{};
  for (int tick = 0; tick < 200; ++tick) force = limit(guard.get(), pushing(2), 0);
  EXPECT_THAT(force.force, Each(0.0));
  EXPECT_TRUE(force.guards & PALPATE_GUARD_STALLED);
}

TEST(CGuard, BeginsFromZeroAfterACallThatWasRefused) {
  const auto guard = test::guardWith();
  const double tool[3] = {0, 0, 0};
  const palpate_touch touch = pushing(2);
  palpate_touch unsized = touch;
  unsized.size = 0;
  auto force = test::sized<palpate_guarded_force>();
  const auto refuse = [&](const double* where, const palpate_touch* what, std::uint32_t flags,
                          palpate_guarded_force* guarded) {
    ASSERT_NEAR(settled(guard.get(), 2).force[0], 2, 1e-9);
    EXPECT_EQ(palpate_guard_limit(guard.get(), where, what, flags, guarded),
              PALPATE_INVALID_ARGUMENT);
    const palpate_guarded_force next = limit(guard.get(), touch);
    EXPECT_LT(next.force[0], 0.05);
    EXPECT_TRUE(next.guards & PALPATE_GUARD_RAMPED);
  };
  refuse(nullptr, &touch, PALPATE_READING_FRESH, &force);
  refuse(tool, nullptr, PALPATE_READING_FRESH, &force);
  refuse(tool, &unsized, PALPATE_READING_FRESH, &force);
  refuse(tool, &touch, 1U << 9, &force);
  refuse(tool, &touch, PALPATE_READING_FRESH, nullptr);
}

TEST(CGuard, ForgetsOnReset) {
  const auto guard = test::guardWith();
  const palpate_guarded_force first = limit(guard.get(), pushing(1));
  settled(guard.get(), 3);
  ASSERT_EQ(palpate_guard_reset(guard.get()), PALPATE_OK);
  EXPECT_EQ(limit(guard.get(), pushing(1)).force[0], first.force[0]);
}

TEST(CGuard, GivesZeroWheneverItRefuses) {
  const auto guard = test::guardWith();
  const double tool[3] = {0, 0, 0};
  const palpate_touch touch = pushing(1);
  const auto refused = [&](palpate_guard* to, const double* at, const palpate_touch* of,
                           std::uint32_t flags) {
    auto force = test::sized<palpate_guarded_force>();
    force.force[0] = 42;
    EXPECT_EQ(palpate_guard_limit(to, at, of, flags, &force), PALPATE_INVALID_ARGUMENT);
    EXPECT_THAT(force.force, Each(0.0));
    return std::string(palpate_last_error());
  };
  EXPECT_THAT(refused(nullptr, tool, &touch, 1), HasSubstr("guard is NULL"));
  EXPECT_THAT(refused(guard.get(), nullptr, &touch, 1), HasSubstr("tool is NULL"));
  EXPECT_THAT(refused(guard.get(), tool, nullptr, 1), HasSubstr("touch is NULL"));
  EXPECT_THAT(refused(guard.get(), tool, &touch, 9), HasSubstr("flags 0x9"));
  palpate_touch unsized = touch;
  unsized.size = 0;
  EXPECT_THAT(refused(guard.get(), tool, &unsized, 1), HasSubstr("touch->size is 0"));
  EXPECT_INVALID(palpate_guard_limit(guard.get(), tool, &touch, 1, nullptr), "guarded is NULL");
  EXPECT_INVALID(palpate_guard_reset(nullptr), "guard is NULL");
  palpate_guard_destroy(nullptr);
}

TEST(CGuard, RefusesOptionsThatMakeNoSense) {
  const auto complaint = [&](double palpate_guard_options::*member, double value) {
    auto options = test::sized<palpate_guard_options>();
    EXPECT_EQ(palpate_guard_defaults("touch", 1e-3, &options), PALPATE_OK);
    options.*member = value;
    palpate_guard* guard = nullptr;
    EXPECT_EQ(palpate_guard_create(&options, &guard), PALPATE_INVALID_ARGUMENT);
    EXPECT_EQ(guard, nullptr);
    return std::string(palpate_last_error());
  };
  EXPECT_THAT(complaint(&palpate_guard_options::period, 0), HasSubstr("period is 0"));
  EXPECT_THAT(complaint(&palpate_guard_options::max_force, test::nan_value),
              HasSubstr("max_force is nan"));
  EXPECT_THAT(complaint(&palpate_guard_options::max_slew, std::numeric_limits<double>::infinity()),
              HasSubstr("max_slew is inf"));
  EXPECT_THAT(complaint(&palpate_guard_options::ramp, -1), HasSubstr("ramp is -1"));
  EXPECT_THAT(complaint(&palpate_guard_options::stall, 0), HasSubstr("stall is 0"));
  EXPECT_THAT(complaint(&palpate_guard_options::max_stiffness, 0), HasSubstr("max_stiffness is 0"));
  EXPECT_THAT(complaint(&palpate_guard_options::energy_credit, -1),
              HasSubstr("energy_credit is -1"));
  EXPECT_THAT(complaint(&palpate_guard_options::delay, -1), HasSubstr("delay is -1"));
  EXPECT_THAT(complaint(&palpate_guard_options::delay, 1), HasSubstr("30 periods"));
  EXPECT_INVALID(palpate_guard_create(nullptr, nullptr), "guard is NULL");
}

}  // namespace
}  // namespace palpate
