#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
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

/// A simulator's own spring that pushes along x.
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

/// The force after a time longer than every ramp.
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

/// The guard's behaviour is tested in tests/viewer/haptics/force_guard_test.cpp.
TEST(CGuard, MatchesTheGuardOfTheProgramsToTheLastBit) {
  for (const double max_slew : {0.0, 500.0}) {
    auto options = test::sized<palpate_guard_options>();
    ASSERT_EQ(palpate_guard_defaults("touch", 1e-3, &options), PALPATE_OK);
    options.max_slew = max_slew;
    GuardOptions ours = guardFor(device_profiles.front(), 1e-3);
    ours.max_slew = max_slew;
    const auto guard = test::guardWith(&options);
    ForceGuard expected(ours);
    std::uint32_t guards = 0;
    for (int n = 0; n < 5000; ++n) {
      GuardInput input;
      input.tool = {0, 0, 0.01 * std::sin(0.02 * n)};
      input.fresh = n % 500 < 460;
      input.lost = n % 1100 == 1000;
      input.late = n % 1300 == 1000;
      input.touch.touching = n % 700 > 50;
      input.touch.stepped = n % 900 == 100;
      input.touch.inside = n % 800 < 700;
      input.touch.force = {n % 1700 == 300 ? test::nan_value : 0.1, n % 600 == 70 ? 40.0 : -0.2,
                           -300 * input.tool.z()};
      input.touch.energy = 150 * input.tool.z() * input.tool.z();
      auto touch = test::sized<palpate_touch>();
      touch.touching = input.touch.touching ? 1 : 0;
      touch.stepped = input.touch.stepped ? 1 : 0;
      touch.inside = input.touch.inside ? 1 : 0;
      std::ranges::copy(input.touch.force, touch.force);
      touch.energy = input.touch.energy;
      auto force = test::sized<palpate_guarded_force>();
      const std::uint32_t flags = (input.fresh ? PALPATE_READING_FRESH : 0U) |
                                  (input.lost ? PALPATE_READING_LOST : 0U) |
                                  (input.late ? PALPATE_LOOP_LATE : 0U);
      ASSERT_EQ(palpate_guard_limit(guard.get(), input.tool.data(), &touch, flags, &force),
                PALPATE_OK);
      const GuardedForce wanted = expected.limit(input);
      ASSERT_EQ(Eigen::Vector3d(force.force), wanted.force) << n;
      ASSERT_EQ(force.guards, wanted.guards) << n;
      ASSERT_EQ(force.passivity, wanted.passivity) << n;
      guards |= force.guards;
    }
    EXPECT_EQ(guards | PALPATE_GUARD_DAMPED, (1U << guard_count) - 1) << "each of them acted";
  }
}

TEST(CGuard, ForgetsOnReset) {
  const auto guard = test::guardWith();
  const palpate_guarded_force first = limit(guard.get(), pushing(1));
  settled(guard.get(), 3);
  ASSERT_EQ(palpate_guard_reset(guard.get()), PALPATE_OK);
  EXPECT_EQ(limit(guard.get(), pushing(1)).force[0], first.force[0]);
}

TEST(CGuard, GivesZeroIfItRefusesAndContinuesFromThere) {
  const auto guard = test::guardWith();
  const double tool[3] = {0, 0, 0};
  const palpate_touch touch = pushing(1);
  const auto refused = [&](palpate_guard* to, const double* at, const palpate_touch* of,
                           std::uint32_t flags) {
    EXPECT_NEAR(settled(guard.get(), 2).force[0], 2, 1e-9);
    auto force = test::sized<palpate_guarded_force>();
    force.force[0] = 42;
    EXPECT_EQ(palpate_guard_limit(to, at, of, flags, &force), PALPATE_INVALID_ARGUMENT);
    EXPECT_THAT(force.force, Each(0.0));
    const std::string said = palpate_last_error();
    if (to != nullptr) {
      EXPECT_LT(limit(guard.get(), pushing(2)).force[0], 0.05);
    }
    return said;
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

TEST(CGuard, RefusesInvalidOptions) {
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
