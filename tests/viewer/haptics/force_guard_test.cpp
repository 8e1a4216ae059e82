#include "viewer/haptics/force_guard.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "common/base/error.hpp"

namespace palpate {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

GuardOptions wideOptions() {
  GuardOptions options;
  options.max_force = 1000;
  options.max_slew = 1e9;
  options.max_stiffness = 1e6;
  return options;
}

GuardInput touching(const Eigen::Vector3d& force,
                    const Eigen::Vector3d& tool = Eigen::Vector3d::Zero()) {
  GuardInput input;
  input.tool = tool;
  input.touch.touching = true;
  input.touch.force = force;
  return input;
}

GuardInput stepped(GuardInput input) {
  input.touch.stepped = true;
  return input;
}

/// A linear spring at the origin, in +y: force k y against y, energy k y^2 / 2.
GuardInput spring(double stiffness, double depth, bool with_energy = true) {
  GuardInput input = touching({0, -stiffness * depth, 0}, {0, depth, 0});
  input.touch.stiffness = Eigen::Vector3d(0, -stiffness, 0).asDiagonal();
  input.touch.energy = with_energy ? 0.5 * stiffness * depth * depth : not_a_number;
  return input;
}

bool has(const GuardedForce& force, Guarded guarded) {
  return (force.guards & static_cast<std::uint32_t>(guarded)) != 0;
}

/// Repeats the same input for `seconds`. Returns the last answer.
GuardedForce hold(ForceGuard& guard, const GuardInput& input, double seconds,
                  const GuardOptions& options = {}) {
  GuardedForce last;
  for (int n = 0; n * options.period < seconds; ++n) last = guard.limit(input);
  return last;
}

TEST(ForceRamp, FadesAStepInEveryTickAndToZeroAtItsEnd) {
  ForceRamp ramp(1e-3, 0.02);
  EXPECT_EQ(ramp.next(), Eigen::Vector3d::Zero());
  const Eigen::Vector3d step(1, -2, 0);
  ramp.begin(step);
  double before = 1;
  for (int tick = 1; tick < 20; ++tick) {
    const Eigen::Vector3d left = ramp.next();
    EXPECT_LT(left.x(), before) << tick;
    EXPECT_EQ(left.y(), -2 * left.x()) << "along the step";
    before = left.x();
  }
  for (int tick = 20; tick < 25; ++tick) EXPECT_LT(ramp.next().norm(), 1e-9) << tick;
}

TEST(ForceRamp, IsZeroAfterAReset) {
  ForceRamp ramp(1e-3, 0.02);
  ramp.begin({1, 0, 0});
  ramp.reset();
  EXPECT_EQ(ramp.next(), Eigen::Vector3d::Zero());
}

TEST(ForceGuard, PassesTheRawForceIfNothingIsWrong) {
  ForceGuard guard({});
  guard.limit({});
  for (int n = 1; n < 100; ++n) {
    const Eigen::Vector3d force(0.01 * n, 0, -0.005 * n);
    const GuardedForce given = guard.limit(touching(force));
    EXPECT_EQ(given.force, force);
    EXPECT_EQ(given.guards, 0U);
  }
}

TEST(ForceGuard, FadesAStepIn) {
  const GuardOptions options;
  ForceGuard guard(options);
  guard.limit({});
  double before = 0;
  GuardedForce given = guard.limit(stepped(touching({0, 2, 0})));
  for (int n = 1; n < 50; ++n) {
    EXPECT_TRUE(has(given, Guarded::ramped)) << n;
    EXPECT_GT(given.force.y(), before);
    // The steepest slope of 3 t^2 - 2 t^3 is 1.5.
    EXPECT_LE(given.force.y() - before, 1.5 * 2 * options.period / options.ramp + 1e-12);
    before = given.force.y();
    given = guard.limit(touching({0, 2, 0}));
  }
  EXPECT_EQ(given.force.y(), 2);
  EXPECT_FALSE(has(given, Guarded::ramped));
}

TEST(ForceGuard, FadesOutTheRemainingForceWhenContactEnds) {
  ForceGuard guard({});
  guard.limit({});
  hold(guard, touching({1, 0, 0}), 0.02);
  GuardInput free;
  GuardedForce given = guard.limit(stepped(free));
  EXPECT_GT(given.force.x(), 0.98);
  given = hold(guard, free, 0.025);
  EXPECT_NEAR(given.force.x(), 0.5, 0.05);
  EXPECT_EQ(hold(guard, free, 0.03).force.norm(), 0);
}

TEST(ForceGuard, ContinuesFromTheGivenForceAtAStepDuringARamp) {
  const GuardOptions options;
  ForceGuard guard(options);
  guard.limit({});
  guard.limit(stepped(touching({0, 3, 0})));
  const double half = hold(guard, touching({0, 3, 0}), 0.02).force.y();
  const double next = guard.limit(stepped(touching({0, -3, 0}))).force.y();
  EXPECT_GT(half, 0.5);
  EXPECT_NEAR(next, half, 0.02);
  EXPECT_EQ(hold(guard, touching({0, -3, 0}), 0.06).force.y(), -3);
}

TEST(ForceGuard, FollowsTheForceEvenIfEveryTickIsAStep) {
  ForceGuard guard({});
  hold(guard, touching({0, 1, 0}), 0.1);
  EXPECT_LT(hold(guard, stepped(touching({0, 0, 0})), 5).force.norm(), 0.01);
}

TEST(ForceGuard, ClampsToTheLargestForceKeepingTheDirection) {
  const GuardOptions options;
  ForceGuard guard(options);
  const GuardedForce given = hold(guard, touching({30, -40, 0}), 0.2);
  EXPECT_TRUE(has(given, Guarded::clamped));
  EXPECT_LE(given.force.norm(), options.max_force);
  EXPECT_NEAR(given.force.norm(), options.max_force, 1e-12);
  EXPECT_NEAR(given.force.x() / given.force.y(), -0.75, 1e-12);
}

TEST(ForceGuard, ChangesNoFasterThanTheSlewLimit) {
  const GuardOptions options;
  ForceGuard guard(options);
  guard.limit({});
  // The raw force changes quickly, but not by a step: a very fast hand.
  for (int n = 1; n <= 9; ++n) {
    const GuardedForce given = guard.limit(touching({3.2, 0, 0}));
    EXPECT_TRUE(has(given, Guarded::slewed));
    EXPECT_NEAR(given.force.x(), 0.33 * n, 1e-12);
  }
  EXPECT_EQ(guard.limit(touching({3.2, 0, 0})).force.x(), 3.2);
}

TEST(ForceGuard, GoesToZeroWhenReadingsStallAndComesBackByARamp) {
  const GuardOptions options;
  ForceGuard guard(options);
  hold(guard, touching({1, 0, 0}), 0.1);
  GuardInput old = touching({1, 0, 0});
  old.fresh = false;
  for (int n = 0; n < 20; ++n) EXPECT_EQ(guard.limit(old).force.x(), 1) << n;
  GuardedForce given = guard.limit(old);
  EXPECT_TRUE(has(given, Guarded::stalled));
  EXPECT_NEAR(given.force.x(), 1 - slewOf(options) * options.period, 1e-12);
  for (int n = 0; n < 3; ++n) given = guard.limit(old);
  EXPECT_EQ(given.force.norm(), 0);

  given = guard.limit(touching({1, 0, 0}));
  EXPECT_FALSE(has(given, Guarded::stalled));
  EXPECT_TRUE(has(given, Guarded::ramped));
  EXPECT_LT(given.force.x(), 0.01);
  EXPECT_EQ(hold(guard, touching({1, 0, 0}), 0.06).force.x(), 1);
}

TEST(ForceGuard, TreatsADeviceOfHalfTheRateAsAlive) {
  ForceGuard guard({});
  for (int n = 0; n < 1000; ++n) {
    GuardInput input = touching({1, 0, 0});
    input.fresh = n % 2 == 0;
    EXPECT_FALSE(has(guard.limit(input), Guarded::stalled));
  }
}

class GuardedReset : public testing::TestWithParam<Guarded> {};

TEST_P(GuardedReset, GivesExactlyZeroAtOnceThenARamp) {
  ForceGuard guard({});
  hold(guard, touching({1, 2, 0}), 0.1);
  GuardInput bad = touching({1, 2, 0});
  bad.lost = GetParam() == Guarded::lost;
  bad.late = GetParam() == Guarded::late;
  for (int n = 0; n < 3; ++n) {
    const GuardedForce given = guard.limit(bad);
    EXPECT_TRUE(has(given, GetParam()));
    EXPECT_EQ(given.force, Eigen::Vector3d::Zero());
    EXPECT_EQ(given.passivity, 0);
  }
  const GuardedForce again = guard.limit(touching({1, 2, 0}));
  EXPECT_TRUE(has(again, Guarded::ramped));
  EXPECT_LT(again.force.norm(), 0.01);
  EXPECT_EQ(hold(guard, touching({1, 2, 0}), 0.06).force, Eigen::Vector3d(1, 2, 0));
}

INSTANTIATE_TEST_SUITE_P(LostAndLate, GuardedReset, testing::Values(Guarded::lost, Guarded::late));

TEST(ForceGuard, SmoothlyGoesToZeroAndBackWhenThePositionOrTheForceIsNotFinite) {
  const double bad_numbers[] = {not_a_number, std::numeric_limits<double>::infinity(), 1e300,
                                -1e12};
  for (const double bad : bad_numbers)
    for (const bool position : {true, false}) {
      ForceGuard guard({});
      double before = hold(guard, touching({0, 0, 2}), 0.1).force.z();
      GuardInput broken = touching({0, 0, 2});
      (position ? broken.tool : broken.touch.force).x() = bad;
      broken.touch.energy = bad;
      for (int n = 0; n < 60; ++n) {
        const GuardedForce given = guard.limit(broken);
        EXPECT_TRUE(has(given, Guarded::not_finite));
        EXPECT_TRUE(given.force.allFinite());
        EXPECT_LE(std::abs(given.force.z() - before), 0.07) << n;
        before = given.force.z();
      }
      EXPECT_EQ(before, 0);
      const GuardedForce again = guard.limit(touching({0, 0, 2}));
      EXPECT_LT(again.force.norm(), 0.01);
      EXPECT_TRUE(std::isfinite(again.passivity));
      EXPECT_EQ(hold(guard, touching({0, 0, 2}), 0.06).force.z(), 2);
    }
}

TEST(ForceGuard, HardlyMovesTheForceForOneBadReading) {
  ForceGuard guard({});
  hold(guard, touching({0, 0, 2}), 0.1);
  guard.limit(touching({0, 0, 2}, {not_a_number, 0, 0}));
  for (int n = 0; n < 60; ++n) EXPECT_NEAR(guard.limit(touching({0, 0, 2})).force.z(), 2, 0.01);
}

TEST(ForceGuard, TreatsAnImpossibleHandMotionAsAStep) {
  for (const bool there_and_back : {true, false}) {
    ForceGuard guard({});
    guard.limit(spring(200, 0));
    for (int n = 1; n <= 100; ++n) guard.limit(spring(200, 2e-5 * n));
    const double before = hold(guard, spring(200, 0.002), 0.05).force.y();
    EXPECT_NEAR(before, -0.4, 1e-9);
    GuardedForce given = guard.limit(spring(200, 0.016));  // 14 mm in a period
    EXPECT_TRUE(has(given, Guarded::ramped));
    double last = given.force.y();
    EXPECT_NEAR(last, before, 0.02);
    for (int n = 0; n < 60; ++n) {
      given = guard.limit(spring(200, there_and_back ? 0.002 : 0.016));
      EXPECT_NEAR(given.force.y(), last, 0.1) << n;
      last = given.force.y();
      EXPECT_TRUE(!there_and_back || std::abs(last - before) < 0.02) << n;
    }
    EXPECT_NEAR(last, there_and_back ? before : -3.2, 1e-9);
  }
}

TEST(ForceGuard, AcceptsAFastHandMotion) {
  ForceGuard guard({});
  for (int n = -40; n < 10; ++n) {
    const GuardedForce given = guard.limit(spring(100, std::max(0.0, 1.5e-3 * n)));
    EXPECT_FALSE(has(given, Guarded::ramped)) << n;
  }
}

/// A hand that presses a spring up and down between 0 and `depth`, as a sine, for whole cycles. The
/// work that it extracts, J: from a spring sampled once per tick, and after the guard.
struct Extracted {
  double held = 0, guarded = 0;
  double least_passivity = 0;
  int damped = 0;
};
Extracted pressSpring(double stiffness, double depth, double hertz, const GuardOptions& options,
                      bool with_energy = true) {
  ForceGuard guard(options);
  guard.limit(spring(stiffness, 0, with_energy));
  Extracted extracted;
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), raw = Eigen::Vector3d::Zero();
  double last = 0;
  const int ticks = static_cast<int>(std::lround(10 / hertz / options.period));
  for (int n = 1; n <= ticks; ++n) {
    const double y =
        0.5 * depth *
        (1 - std::cos(2 * std::numbers::pi * hertz * static_cast<double>(n) * options.period));
    extracted.held += raw.y() * (y - last);
    extracted.guarded += force.y() * (y - last);
    last = y;
    const GuardInput input = spring(stiffness, y, with_energy);
    const GuardedForce given = guard.limit(input);
    raw = input.touch.force;
    force = given.force;
    extracted.least_passivity = std::min(extracted.least_passivity, given.passivity);
    extracted.damped += has(given, Guarded::damped) ? 1 : 0;
  }
  return extracted;
}

TEST(EnergyLimit, RemovesTheEnergyCreatedBySamplingASpring) {
  const GuardOptions options = wideOptions();
  const double stiffness = 1000, depth = 0.01, hertz = 5;
  const Extracted extracted = pressSpring(stiffness, depth, hertz, options);
  // The power is K T v^2 / 2 with the mean of v^2 over a cycle; ten cycles.
  const double speed = std::numbers::pi * hertz * depth;
  const double created = stiffness * options.period * speed * speed / 4 * 10 / hertz;
  EXPECT_NEAR(extracted.held, created, 0.01 * created);
  const double of_one_tick = 0.5 * stiffness * std::pow(speed * options.period, 2);
  EXPECT_LE(extracted.guarded, 2 * of_one_tick);
  // The guard's energy sum falls by `created` / 20 on the way in and rises again on the way out.
  EXPECT_GE(extracted.least_passivity, -1.1 * created / 20);
  EXPECT_GT(extracted.damped, 900);
}

TEST(EnergyLimit, WithoutAStoredEnergyReturnsNoMoreThanTheHandGave) {
  const GuardOptions options = wideOptions();
  const Extracted extracted = pressSpring(1000, 0.01, 5, options, false);
  EXPECT_GT(extracted.held, 0.01);
  EXPECT_LE(extracted.guarded, 1e-3);
  EXPECT_GT(extracted.damped, 0);
}

TEST(EnergyLimit, DoesNotActOnAHandThatLosesEnergy) {
  GuardOptions options = wideOptions();
  ForceGuard guard(options);
  guard.limit(spring(100, 0));
  int damped = 0;
  for (int n = 1; n < 2000; ++n) {
    const double y = 0.01 * (1 - std::cos(0.01 * n)),
                 speed = 0.0001 * std::sin(0.01 * n) / options.period;
    GuardInput input = spring(100, y);
    input.touch.force.y() -= 5 * speed;  // an additional damper
    damped += has(guard.limit(input), Guarded::damped) ? 1 : 0;
  }
  // The guard damps only near the surface, where the stored energy is below its uncertainty.
  EXPECT_LE(damped, 40);
}

TEST(EnergyLimit, NeitherTurnsNorEnlargesTheForce) {
  ForceGuard guard(wideOptions());
  guard.limit(spring(1000, 0));
  std::mt19937 random(7);
  std::uniform_real_distribution<double> speed(-0.5, 0.5);
  double y = 0, damped = 0;
  for (int n = 0; n < 5000; ++n) {
    y = std::clamp(y + speed(random) * 1e-3, 0.0, 0.01);
    GuardInput input = spring(1000, y);
    input.touch.energy += n * 1e-5;  // as if the stored energy grew without input
    const GuardedForce given = guard.limit(input);
    EXPECT_EQ(given.force.x(), 0);
    EXPECT_EQ(given.force.z(), 0);
    EXPECT_LE(given.force.y(), 0);
    EXPECT_GE(given.force.y(), input.touch.force.y() - 1e-12);
    damped += has(given, Guarded::damped) ? 1 : 0;
  }
  EXPECT_GT(damped, 100);
}

TEST(EnergyLimit, ToleratesQuantizedPositions) {
  ForceGuard guard({});
  guard.limit(spring(400, 0));
  for (int n = 1; n <= 500; ++n) guard.limit(spring(400, 1e-5 * n));
  std::mt19937 random(3);
  for (int n = 0; n < 20000; ++n) {
    const GuardInput input = spring(400, 0.005 + (random() % 2 == 0 ? 0 : 5e-5));
    const GuardedForce given = guard.limit(input);
    EXPECT_GT(given.passivity, -1e-3) << n;
    EXPECT_LE(given.force.y(), 0.9 * input.touch.force.y()) << n;
  }
}

TEST(EnergyLimit, DoesNotMistakeAClampedForceForCreatedEnergy) {
  GuardOptions options = wideOptions();
  options.max_force = 2;  // the spring reaches 10 N
  const Extracted extracted = pressSpring(1000, 0.01, 1, options);
  const double speed = std::numbers::pi * 1 * 0.01;
  EXPECT_GE(extracted.least_passivity, -1000 * options.period * speed * speed / 8);
  EXPECT_LE(extracted.guarded, 1e-4);
}

TEST(EnergyLimit, CountsNoSwitchOfModelsAsWork) {
  ForceGuard guard({});
  guard.limit(spring(50, 0));
  for (int n = 1; n <= 1000; ++n) guard.limit(spring(50, 1e-5 * n));
  // Ten times the stored energy and ten times the force at once.
  GuardedForce given = guard.limit(stepped(spring(500, 0.01)));
  EXPECT_GE(given.passivity, -1e-4);
  given = hold(guard, spring(500, 0.01), 0.2);
  EXPECT_GE(given.passivity, -1e-4);
}

TEST(EnergyLimit, RemembersNoMoreThanItsCredit) {
  const GuardOptions options;
  ForceGuard guard(options);
  guard.limit(spring(100, 0));
  for (int n = 1; n < 5000; ++n) {
    const double y = 0.001 * (1 - std::cos(0.05 * n));
    GuardInput input = spring(100, y);
    input.touch.force.y() -=
        100 * 0.00005 * std::sin(0.05 * n);  // like friction: more and more is dissipated
    EXPECT_LE(guard.limit(input).passivity, options.energy_credit + 1e-12);
  }
  GuardInput free;
  free.tool = {0, 0.001, 0};
  const double kept = guard.limit(stepped(free)).passivity;
  EXPECT_LE(std::abs(kept), options.energy_credit);
}

/// Any input that a broken device, dataset or method could give.
GuardInput anything(std::mt19937_64& random) {
  const auto number = [&random](double usual) {
    std::uniform_int_distribution<int> kind(0, 40);
    const double sign = random() % 2 == 0 ? 1 : -1;
    switch (kind(random)) {
      case 0: return not_a_number;
      case 1: return sign * std::numeric_limits<double>::infinity();
      case 2: return sign * 1e300;
      case 3: return sign * 1e8;
      case 4: return sign * 1e-300;
      default: return usual * std::uniform_real_distribution<double>(-1, 1)(random);
    }
  };
  GuardInput input;
  input.tool = {number(0.05), number(0.05), number(0.05)};
  input.touch.touching = random() % 4 != 0;
  input.touch.stepped = random() % 10 == 0;
  input.touch.force = {number(5), number(5), number(5)};
  input.touch.energy = number(0.1);
  for (int entry = 0; entry < 9; ++entry) input.touch.stiffness(entry) = number(500);
  input.fresh = random() % 3 != 0;
  input.lost = random() % 50 == 0;
  input.late = random() % 50 == 0;
  return input;
}

TEST(ForceGuard, KeepsItsLimitsForAnyInput) {
  std::mt19937_64 random(11);
  for (const double max_force : {0.9, 3.3, 22.0}) {
    GuardOptions options = guardFor({"any", max_force, 400, 0.1}, 1e-3);
    ForceGuard guard(options);
    GuardInput input = anything(random);
    Eigen::Vector3d before = Eigen::Vector3d::Zero();
    for (int n = 0; n < 100000; ++n) {
      if (random() % 3 != 0) input = anything(random);  // some inputs stay for a while
      const GuardedForce given = guard.limit(input);
      ASSERT_TRUE(given.force.allFinite()) << n;
      ASSERT_TRUE(std::isfinite(given.passivity)) << n;
      ASSERT_LE(given.force.norm(), max_force) << n;
      if (input.lost || input.late)
        ASSERT_EQ(given.force, Eigen::Vector3d::Zero()) << n;
      else
        ASSERT_LE((given.force - before).norm(), slewOf(options) * options.period * (1 + 1e-9))
            << n;
      before = given.force;
    }
  }
}

TEST(ForceGuard, DependsOnItsInputsAlone) {
  std::mt19937_64 random(12);
  ForceGuard first({}), second({});
  second.limit(touching({1, 1, 1}));
  second.reset();
  for (int n = 0; n < 10000; ++n) {
    const GuardInput input = anything(random);
    const GuardedForce a = first.limit(input), b = second.limit(input);
    ASSERT_EQ(a.force, b.force);
    ASSERT_EQ(a.guards, b.guards);
    ASSERT_EQ(a.passivity, b.passivity);
  }
}

TEST(GuardOptions, AreThoseOfTheDevice) {
  const GuardOptions options = guardFor({"omega", 12, 5000, 0.075}, 2e-4);
  EXPECT_EQ(options.period, 2e-4);
  EXPECT_EQ(options.max_force, 12);
  EXPECT_EQ(options.max_stiffness, 5000);
  EXPECT_NEAR(slewOf(options), 1200, 1e-9);
}

TEST(GuardOptions, CannotSwitchTheGuardOff) {
  for (const double bad : {0.0, -1.0, not_a_number, std::numeric_limits<double>::infinity()}) {
    GuardOptions options;
    options.max_force = bad;
    EXPECT_THROW(ForceGuard{options}, Error) << bad;
    options = {};
    options.period = bad;
    EXPECT_THROW(ForceGuard{options}, Error) << bad;
  }
  GuardOptions options;
  options.stall = not_a_number;
  EXPECT_THROW(ForceGuard{options}, Error);
  options = {};
  options.max_slew = -1;
  EXPECT_THROW(ForceGuard{options}, Error);
  options = {};
  options.delay = 1;
  EXPECT_THROW(ForceGuard{options}, Error);
}

TEST(GuardOptions, AllowTheWholeForceIn10MillisecondsByDefault) {
  GuardOptions options;
  options.max_force = 12;
  EXPECT_NEAR(slewOf(options), 1200, 1e-9);
  options.max_slew = 50;
  EXPECT_EQ(slewOf(options), 50);
}

TEST(GuardWord, NamesEachBit) {
  EXPECT_STREQ(guardWord(0), "ramped");
  EXPECT_STREQ(guardWord(7), "late");
  EXPECT_STREQ(guardWord(guard_count), "");
}

}  // namespace
}  // namespace palpate
