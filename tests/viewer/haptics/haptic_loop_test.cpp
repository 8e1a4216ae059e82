#include "viewer/haptics/haptic_loop.hpp"

#include <gtest/gtest.h>
#include <pthread.h>

#include <chrono>
#include <csignal>
#include <ctime>

#include "tests/support/expect_error.hpp"
#include "tests/viewer/haptics/scripted_hand.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;
using test::fresh;
using test::pressAndSlide;
using test::ScriptedHand;

/// Waits until `holds` is true, with a limit that only a hang exceeds.
template <class Holds>
bool waitFor(const Holds& holds) {
  const auto end = std::chrono::steady_clock::now() + 60s;
  while (!holds() && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(1ms);
  return holds();
}

class HapticLoopTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { cube = new test::TouchedCube; }
  static void TearDownTestSuite() { delete cube; }
  static TickOptions tickOptions(double rate = 1000) {
    TickOptions options;
    options.period = 1 / rate;
    options.guard = guardFor({"omega", 12, 5000, 0.075}, options.period);
    return options;
  }
  static LoopOptions loopOptions(std::uint64_t ticks, double rate = 1000) {
    LoopOptions options;
    options.rate = rate;
    options.ticks = ticks;
    options.watchdog = 30;  // for a busy machine; tests of the watchdog set their own
    return options;
  }
  static void runToTheEnd(HapticLoop& loop) {
    loop.start();
    EXPECT_TRUE(waitFor([&loop] { return !loop.running(); }));
    loop.stop();
  }
  static std::vector<const HapticModel*> models() { return {&cube->model()}; }

  static inline test::TouchedCube* cube = nullptr;
};

TEST_F(HapticLoopTest, RunsTheRequestedTicksAndEndsWithZeroForce) {
  ScriptedHand hand([](std::uint64_t) { return fresh(pressAndSlide(0.4)); });
  HapticTick tick(models(), hand, tickOptions());
  HapticLoop loop(tick, hand, loopOptions(300));
  EXPECT_FALSE(loop.running());
  runToTheEnd(loop);
  const LoopStatistics statistics = loop.statistics();
  EXPECT_EQ(hand.reads, 300U);
  EXPECT_EQ(hand.forces.size(), 301U);
  EXPECT_EQ(hand.last_force, Eigen::Vector3d::Zero());
  EXPECT_EQ(statistics.rate, 1000);
  EXPECT_EQ(statistics.ticks, 300U);
  EXPECT_EQ(statistics.period.count(), 299U);
  EXPECT_EQ(statistics.latency.count(), 300U);
  EXPECT_EQ(statistics.compute.count(), 300U);
  EXPECT_EQ(statistics.processor.count(), 300U);
  EXPECT_EQ(statistics.halts, 0U);
  EXPECT_EQ(loop.latest().tick, 300U);
}

TEST_F(HapticLoopTest, StopsOnRequest) {
  ScriptedHand hand(test::pressingAndSliding());
  HapticTick tick(models(), hand, tickOptions());
  HapticLoop loop(tick, hand, loopOptions(0));
  loop.start();
  EXPECT_TRUE(loop.running());
  EXPECT_TRUE(waitFor([&loop] { return loop.latest().tick > 20; }));
  loop.stop();
  EXPECT_FALSE(loop.running());
  EXPECT_EQ(loop.statistics().ticks, hand.reads);
  EXPECT_EQ(hand.last_force, Eigen::Vector3d::Zero());
  loop.stop();  // a second call does nothing
}

/// During the pause the device held zero, but the guard remembers the force before it.
TEST_F(HapticLoopTest, ResumesAnEarlierTickFromZeroByARamp) {
  ScriptedHand pressing([](std::uint64_t n) {
    return fresh(
        {0.05, 0.05, 0.101 - 2.5e-4 * static_cast<double>(std::min<std::uint64_t>(n, 24))});
  });
  HapticTick pressed(models(), pressing, tickOptions());
  HapticLoop before(pressed, pressing, loopOptions(200));
  runToTheEnd(before);
  const double held = pressed.state().force.norm();
  ASSERT_GT(held, 0.1);

  pressing.forces.clear();
  HapticLoop after(pressed, pressing, loopOptions(200));
  runToTheEnd(after);
  EXPECT_EQ(pressing.forces.front(), Eigen::Vector3d::Zero());
  EXPECT_LT(pressing.forces[2].norm(), 0.1 * held);
  EXPECT_NEAR(pressed.state().force.norm(), held, 0.05 * held);
}

TEST_F(HapticLoopTest, CannotBeStartedTwiceOrAtAnotherRateThanItsTick) {
  ScriptedHand hand(test::pressingAndSliding());
  HapticTick tick(models(), hand, tickOptions());
  test::expectBadInput([&] { HapticLoop(tick, hand, loopOptions(1, 5000)); }, {"5000", "rate"});
  HapticLoop loop(tick, hand, loopOptions(10));
  loop.start();
  EXPECT_THROW(loop.start(), std::logic_error);
  loop.stop();
  EXPECT_THROW(loop.start(), std::logic_error);
}

TEST_F(HapticLoopTest, RecordsEveryTickAndEqualsTheTickAlone) {
  constexpr std::uint64_t ticks = 20000;  // more than the queue can hold
  ScriptedHand hand(test::pressingAndSliding()), alone(test::pressingAndSliding());
  HapticTick tick(models(), hand, tickOptions()), tick_alone(models(), alone, tickOptions());
  LoopOptions options = loopOptions(ticks);
  options.free_running = options.record = true;
  HapticLoop loop(tick, hand, options);
  loop.start();
  std::uint64_t taken = 0;
  EXPECT_TRUE(waitFor([&] {
    while (const auto state = loop.takeRecorded()) {
      const HapticState& wanted = tick_alone.run();
      EXPECT_EQ(state->tick, ++taken);
      EXPECT_EQ(state->force, wanted.force);
      EXPECT_EQ(state->guards, wanted.guards);
    }
    return taken == ticks;
  }));
  loop.stop();
  EXPECT_FALSE(loop.takeRecorded().has_value());
  EXPECT_EQ(loop.statistics().not_recorded, 0U);
  EXPECT_EQ(loop.statistics().contacts, 20U);
  EXPECT_EQ(loop.statistics().missed_program + loop.statistics().missed_system, 0U);
}

TEST_F(HapticLoopTest, CountsStatesThatWereNotRead) {
  constexpr std::uint64_t ticks = 8192 + 200;
  ScriptedHand hand(test::pressingAndSliding());
  HapticTick tick(models(), hand, tickOptions(20000));
  LoopOptions options = loopOptions(ticks, 20000);
  options.record = true;
  HapticLoop loop(tick, hand, options);
  runToTheEnd(loop);
  std::uint64_t taken = 0;
  while (loop.takeRecorded()) ++taken;
  EXPECT_EQ(taken, 8192U);
  EXPECT_EQ(loop.statistics().not_recorded, 200U);
}

TEST_F(HapticLoopTest, ObeysCommands) {
  ScriptedHand hand(test::pressingAndSliding());
  HapticTick tick(models(), hand, tickOptions());
  HapticLoop loop(tick, hand, loopOptions(0));
  loop.start();
  EXPECT_EQ(loop.latest().method, 0);
  EXPECT_TRUE(loop.command({HapticCommand::Kind::use, 0, 1}));
  EXPECT_TRUE(waitFor([&loop] { return loop.latest().method == 1; }));
}

TEST_F(HapticLoopTest, RefusesCommandsIfTheyAreNotRead) {
  ScriptedHand hand(test::pressingAndSliding());
  HapticTick tick(models(), hand, tickOptions());
  HapticLoop loop(tick, hand, loopOptions(0));
  int taken = 0;
  while (taken < 1000 && loop.command({})) ++taken;
  EXPECT_EQ(taken, 64);
}

TEST_F(HapticLoopTest, HaltsAHungDeviceAndContinuesFromZero) {
  std::atomic<const ScriptedHand*> watched = nullptr;
  ScriptedHand hand([&watched](std::uint64_t tick) {
    // Hangs in the middle of a press until the watchdog has seen it.
    EXPECT_TRUE(tick != 400 || waitFor([&] { return watched.load()->halts > 0; }));
    return fresh(pressAndSlide(1e-3 * static_cast<double>(tick)));
  });
  watched = &hand;
  HapticTick tick(models(), hand, tickOptions());
  LoopOptions options = loopOptions(700);
  options.watchdog = 0.1;
  options.record = true;
  HapticLoop loop(tick, hand, options);
  runToTheEnd(loop);
  EXPECT_GE(loop.statistics().halts, 1U);
  EXPECT_EQ(hand.halts, static_cast<int>(loop.statistics().halts));
  EXPECT_EQ(hand.resumes, hand.halts + 1);  // one more, at the start
  EXPECT_GE(loop.statistics().guards[7], 1U);

  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  bool was_late = false;
  while (const auto state = loop.takeRecorded()) {
    if ((state->guards & static_cast<std::uint32_t>(Guarded::late)) != 0) {
      EXPECT_EQ(state->force, Eigen::Vector3d::Zero());
      was_late = true;
    } else {
      EXPECT_LE((state->force - before).norm(), 0.1);
    }
    before = state->force;
  }
  EXPECT_TRUE(was_late);
}

TEST_F(HapticLoopTest, KeepsALostDeviceHaltedAndResumesItAfterZero) {
  const ScriptedHand* watched = nullptr;
  ScriptedHand hand([&watched](std::uint64_t tick) {
    DeviceReading reading = fresh(pressAndSlide(1e-3 * static_cast<double>(tick)));
    if (tick < 400 || tick >= 420) return reading;
    EXPECT_EQ(watched->resumes, 1) << "only at the start";
    EXPECT_TRUE(tick != 419 || waitFor([&] { return watched->halts > 0; }));
    return DeviceReading{};
  });
  watched = &hand;
  HapticTick tick(models(), hand, tickOptions());
  HapticLoop loop(tick, hand, loopOptions(700));
  runToTheEnd(loop);
  EXPECT_EQ(hand.resumes, hand.halts + 1);
  EXPECT_EQ(loop.statistics().halts, 0U);
  EXPECT_NE(hand.forces.at(398), Eigen::Vector3d::Zero());
  for (std::size_t n = 399; n <= 419; ++n)
    EXPECT_EQ(hand.forces.at(n), Eigen::Vector3d::Zero()) << n;
  EXPECT_GE(loop.statistics().guards[7], 1U);
}

/// SCHED_OTHER: 0.
int priorityHere() {
  int policy = 0;
  sched_param priority{};
  pthread_getschedparam(pthread_self(), &policy, &priority);
  return policy == SCHED_FIFO ? priority.sched_priority : 0;
}

TEST_F(HapticLoopTest, TheWatchdogPreemptsASpinningLoop) {
  struct WatchedHand : ScriptedHand {
    using ScriptedHand::ScriptedHand;
    void halt() noexcept override {
      watchdog = priorityHere();
      ScriptedHand::halt();
    }
    std::atomic<int> watchdog = 0, loop = 0;
  };
  WatchedHand* watched = nullptr;
  std::atomic<bool> started = false;
  WatchedHand hand([&](std::uint64_t) {
    watched->loop = priorityHere();
    return started ? DeviceReading{} : fresh({0, 0, 1});
  });
  watched = &hand;
  HapticTick tick(models(), hand, tickOptions());
  LoopOptions options = loopOptions(0);
  options.real_time = true;
  HapticLoop loop(tick, hand, options);
  loop.start();
  started = true;
  EXPECT_TRUE(waitFor([&hand] { return hand.halts > 0; }));
  loop.stop();
  if (hand.loop == 0) GTEST_SKIP() << "no real-time priority here: " << loop.trouble();
  if (loop.trouble().find("watchdog thread") != std::string::npos) GTEST_SKIP() << loop.trouble();
  EXPECT_EQ(hand.watchdog, hand.loop + 1);
}

TEST_F(HapticLoopTest, RequestsRealTimeForDeviceThreadsAndReportsRefusals) {
  struct ThreadedHand : ScriptedHand {
    using ScriptedHand::ScriptedHand;
    std::string askForRealTime() override { return "The device thread has none. "; }
  };
  for (const bool real_time : {false, true}) {
    ThreadedHand hand([](std::uint64_t) { return fresh({0, 0, 1}); });
    HapticTick tick(models(), hand, tickOptions());
    LoopOptions options = loopOptions(1);
    options.real_time = real_time;
    HapticLoop loop(tick, hand, options);
    runToTheEnd(loop);
    EXPECT_EQ(loop.trouble().ends_with("The device thread has none. "), real_time);
  }
}

void compute(double cpu_seconds) {
  const auto now = [] {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  };
  for (const double end = now() + cpu_seconds; now() < end;) {
  }
}

TEST_F(HapticLoopTest, DistinguishesDeadlinesMissedByProgramAndSystem) {
  ScriptedHand hand([](std::uint64_t tick) {
    if (tick % 10 == 0) compute(0.025);
    return fresh({0, 0, 1});
  });
  HapticTick tick(models(), hand, tickOptions(50));
  HapticLoop loop(tick, hand, loopOptions(40, 50));
  runToTheEnd(loop);
  EXPECT_EQ(loop.statistics().missed_program, 4U);

  ScriptedHand waiting([](std::uint64_t n) {
    if (n % 10 == 0) std::this_thread::sleep_for(25ms);
    return fresh({0, 0, 1});
  });
  HapticTick waiting_tick(models(), waiting, tickOptions(50));
  HapticLoop waiting_loop(waiting_tick, waiting, loopOptions(40, 50));
  runToTheEnd(waiting_loop);
  EXPECT_EQ(waiting_loop.statistics().missed_program, 0U);
  EXPECT_GE(waiting_loop.statistics().missed_system, 4U);
}

TEST_F(HapticLoopTest, ContinuesItsSleepAfterASignal) {
  std::atomic<pthread_t> haptic_thread = 0;
  std::atomic<std::int64_t> first_ns = 0, last_ns = 0;
  ScriptedHand hand([&](std::uint64_t) {
    const std::int64_t now = std::chrono::steady_clock::now().time_since_epoch().count();
    if (haptic_thread.load() == 0) first_ns = now;
    haptic_thread = pthread_self();
    last_ns = now;
    return fresh({0, 0, 1});
  });
  struct sigaction handler {};
  handler.sa_handler = [](int) {};
  struct sigaction before {};
  ASSERT_EQ(sigaction(SIGUSR1, &handler, &before), 0);
  HapticTick tick(models(), hand, tickOptions(100));
  HapticLoop loop(tick, hand, loopOptions(0, 100));
  loop.start();
  EXPECT_TRUE(waitFor([&] { return haptic_thread.load() != 0; }));
  EXPECT_TRUE(waitFor([&] {
    pthread_kill(haptic_thread, SIGUSR1);
    return loop.latest().tick >= 20;
  }));
  loop.stop();
  sigaction(SIGUSR1, &before, nullptr);
  const auto ticks = static_cast<double>(hand.reads);
  EXPECT_GE(1e-9 * static_cast<double>(last_ns - first_ns), (ticks - 2) * 0.01);
}

TEST_F(HapticLoopTest, ContinuesWithoutRealTimeAndExplainsTheRemedy) {
  ScriptedHand hand(test::pressingAndSliding());
  HapticTick tick(models(), hand, tickOptions());
  LoopOptions options = loopOptions(50);
  options.real_time = true;
  HapticLoop loop(tick, hand, options);
  runToTheEnd(loop);
  EXPECT_EQ(loop.statistics().ticks, 50U);
  const std::string trouble = loop.trouble();
  const auto tells = [&trouble](const char* what) {
    return trouble.find(what) != std::string::npos;
  };
  EXPECT_EQ(tells("priority"), tells("ulimit -r")) << trouble;
  EXPECT_EQ(tells("Memory"), tells("ulimit -l")) << trouble;

  HapticTick modest_tick(models(), hand, tickOptions());
  HapticLoop modest(modest_tick, hand, loopOptions(1));
  runToTheEnd(modest);
  EXPECT_EQ(modest.trouble(), "");
}

TEST_F(HapticLoopTest, HandsOverCompleteStatesInOrder) {
  constexpr std::uint64_t ticks = 60000;
  ScriptedHand hand(test::pressingAndSliding());
  HapticTick tick(models(), hand, tickOptions());
  LoopOptions options = loopOptions(ticks);
  options.free_running = options.record = true;
  HapticLoop loop(tick, hand, options);
  loop.start();
  std::thread recording([&loop] {
    std::uint64_t next = 1;
    EXPECT_TRUE(waitFor([&] {
      while (const auto state = loop.takeRecorded()) EXPECT_EQ(state->tick, next++);
      return next > ticks;
    }));
  });
  std::uint64_t seen = 0;
  EXPECT_TRUE(waitFor([&] {
    for (int n = 0; n < 1000; ++n) {
      const HapticState& state = loop.latest();
      EXPECT_GE(state.tick, seen);
      seen = state.tick;
      if (state.tick == 0) continue;
      EXPECT_EQ(state.time, static_cast<double>(state.tick) * 1e-3);
      EXPECT_EQ(state.tool, pressAndSlide(1e-3 * static_cast<double>(state.tick)));
    }
    EXPECT_LE(loop.statistics().ticks, ticks);
    return seen == ticks;
  }));
  recording.join();
}

}  // namespace
}  // namespace palpate
