// Calls that are forbidden in the haptic thread, counted in the C library and refused by the
// kernel. A separate program, because it replaces malloc and pthread_mutex_lock.

#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <mutex>
#include <thread>
#include <vector>

#include "tests/viewer/haptics/counted_calls.hpp"
#include "tests/viewer/haptics/scripted_hand.hpp"
#include "viewer/haptics/haptic_loop.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;
using test::CallCounts;
using test::ScriptedHand;

constexpr std::uint64_t counted_ticks = 10000;

TickOptions tickOptions(double rate) {
  TickOptions options;
  options.period = 1 / rate;
  options.guard = guardFor({"omega", 12, 5000, 0.075}, options.period);
  return options;
}

/// Presses and slides; sometimes it is lost, sends NaN or repeats a reading.
DeviceReading troubledHand(std::uint64_t tick, double period) {
  DeviceReading reading = test::fresh(test::pressAndSlide(period * static_cast<double>(tick)));
  if (tick % 1700 < 20) reading.status = DeviceStatus::lost;
  if (tick % 1300 == 5) reading.position.y() = std::nan("");
  if (tick % 3 == 0) reading.status = DeviceStatus::repeated;
  return reading;
}

class RealTime : public testing::Test {
 protected:
  static void SetUpTestSuite() { cube = new test::TouchedCube; }
  static void TearDownTestSuite() { delete cube; }
  static std::vector<const HapticModel*> models() { return {&cube->model()}; }
  static inline test::TouchedCube* cube = nullptr;
};

TEST_F(RealTime, CountersCount) {
  std::mutex mutex;
  test::startCounting();
  void* const memory = ::operator new(100);
  const std::unique_lock lock(mutex);
  ::operator delete(memory);
  void* volatile more = std::malloc(100);  // volatile, so that the compiler keeps both calls
  std::free(more);
  const CallCounts counts = test::stopCounting();
  EXPECT_EQ(counts.allocations, 2);
  EXPECT_EQ(counts.frees, 2);
  EXPECT_EQ(counts.locks, 1);
}

TEST_F(RealTime, TheTickNeitherAllocatesNorLocks) {
  ScriptedHand hand([](std::uint64_t tick) { return troubledHand(tick, 1e-3); });
  HapticTick tick(models(), hand, tickOptions(1000));
  std::uint64_t touched = 0;
  test::startCounting();
  for (std::uint64_t n = 0; n < counted_ticks; ++n) {
    if (n % 500 == 250) tick.obey({HapticCommand::Kind::use, 0, n % 1000 == 250 ? 1 : 0});
    if (n % 900 == 450) tick.obey({HapticCommand::Kind::release, 0, 0});
    touched += tick.run(n % 2100 == 1000).touch.touching ? 1U : 0U;
  }
  const CallCounts counts = test::stopCounting();
  EXPECT_GT(touched, 1000U);
  EXPECT_EQ(counts.allocations, 0);
  EXPECT_EQ(counts.frees, 0);
  EXPECT_EQ(counts.locks, 0);
  EXPECT_EQ(counts.prints, 0);
}

/// From now on, any system call except the end of the process ends the process with SIGSYS.
bool forbidSystemCalls() {
  sock_filter rules[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_exit_group, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS),
  };
  const sock_fprog program = {std::size(rules), rules};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

constexpr int refused_by_kernel = 77;

/// The exit status of a child that runs `action` without system calls.
template <class Action>
int withoutSystemCalls(const Action& action) {
  const pid_t child = fork();
  if (child == 0) {
    if (!forbidSystemCalls()) _exit(refused_by_kernel);
    action();
    syscall(SYS_exit_group, 0);
  }
  int status = -1;
  return waitpid(child, &status, 0) == child ? status : -1;
}

TEST_F(RealTime, TheTickMakesNoSystemCall) {
  const int forbidden = withoutSystemCalls([] { syscall(SYS_getppid); });
  if (WIFEXITED(forbidden) && WEXITSTATUS(forbidden) == refused_by_kernel)
    GTEST_SKIP() << "this kernel does not support seccomp filters";
  EXPECT_TRUE(WIFSIGNALED(forbidden)) << forbidden;

  ScriptedHand hand([](std::uint64_t tick) { return troubledHand(tick, 1e-3); });
  HapticTick tick(models(), hand, tickOptions(1000));
  const int status = withoutSystemCalls([&tick] {
    for (std::uint64_t n = 0; n < counted_ticks; ++n) tick.run(n % 2100 == 1000);
  });
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
}

TEST_F(RealTime, TheLoopNeitherAllocatesNorLocksBetweenTicks) {
  constexpr double rate = 10000;
  constexpr std::uint64_t first = 100, last = first + counted_ticks;
  CallCounts counts;
  ScriptedHand hand([&counts](std::uint64_t tick) {
    if (tick == last) counts = test::stopCounting();
    DeviceReading reading = troubledHand(tick, 1 / rate);
    if (tick == first) test::startCounting();
    return reading;
  });
  HapticTick tick(models(), hand, tickOptions(rate));
  LoopOptions options;
  options.rate = rate;
  options.ticks = last + 10;
  options.record = true;
  options.watchdog = 60;
  HapticLoop loop(tick, hand, options);
  loop.start();
  // The other threads may read, take states and send commands.
  std::uint64_t taken = 0;
  for (std::int32_t n = 0; loop.running() && n < 600000; ++n) {
    loop.command({HapticCommand::Kind::use, 0, n / 100 % 2});
    while (loop.takeRecorded()) ++taken;
    EXPECT_LE(loop.latest().tick, options.ticks);
    std::this_thread::sleep_for(100us);
  }
  loop.stop();
  while (loop.takeRecorded()) ++taken;
  EXPECT_EQ(loop.statistics().ticks, options.ticks);
  EXPECT_EQ(taken + loop.statistics().not_recorded, options.ticks);
  EXPECT_EQ(counts.allocations, 0);
  EXPECT_EQ(counts.frees, 0);
  EXPECT_EQ(counts.locks, 0);
  EXPECT_EQ(counts.prints, 0);
}

}  // namespace
}  // namespace palpate
