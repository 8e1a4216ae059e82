#include "scheduler/verbs/service_manager.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <vector>

#include "tests/support/notify_socket.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

/// Receives what systemd would at $NOTIFY_SOCKET.
struct ServiceManagerTest : testing::Test {
  test::TemporaryDirectory directory;
  test::NotifySocket socket{directory.path()};
  ServiceManager::Clock::time_point now{1h};

  void TearDown() override {
    for (const char* name : {"WATCHDOG_USEC", "WATCHDOG_PID"}) unsetenv(name);
  }
  std::vector<std::string> heard() const { return socket.heard(); }
  static std::string status() { return "3/5 points"; }
};

TEST_F(ServiceManagerTest, IsToldReadinessAndProgress) {
  ServiceManager manager;
  manager.mayTake(1h, "reading");
  manager.ready();
  for (int turn = 0; turn < 3; ++turn) manager.alive(now, status);
  manager.alive(now + 6s, status);
  manager.stopping();
  EXPECT_THAT(heard(), ElementsAre("STATUS=reading\nEXTEND_TIMEOUT_USEC=3600000000", "READY=1",
                                   "STATUS=3/5 points", "STATUS=3/5 points", "STOPPING=1"));
}

TEST_F(ServiceManagerTest, GetsTwoSignsOfLifeInItsTimeout) {
  setenv("WATCHDOG_USEC", "2000000", 1);
  setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
  ServiceManager manager;
  manager.mayTake(1h, "reading");
  manager.ready();
  EXPECT_THAT(heard(), ElementsAre("STATUS=reading\nEXTEND_TIMEOUT_USEC=3600000000\n"
                                   "WATCHDOG_USEC=3600000000",
                                   "READY=1\nWATCHDOG_USEC=2000000"));
  std::ptrdiff_t signs = 0;
  for (auto time = now; time < now + 4s; time += 50ms) {
    manager.alive(time, status);
    signs += std::ranges::count(heard(), "WATCHDOG=1");
  }
  EXPECT_EQ(signs, 4);
}

TEST_F(ServiceManagerTest, ExpectsNoSignOfLifeFromAnotherProcess) {
  setenv("WATCHDOG_USEC", "2000000", 1);
  setenv("WATCHDOG_PID", "1", 1);
  ServiceManager manager;
  manager.alive(now, status);
  EXPECT_THAT(heard(), ElementsAre("STATUS=3/5 points"));
}

TEST_F(ServiceManagerTest, IsNotInheritedByChildProcesses) {
  const ServiceManager manager;
  EXPECT_EQ(std::getenv("NOTIFY_SOCKET"), nullptr);
}

TEST_F(ServiceManagerTest, AMissingOneStopsNothing) {
  socket.remove();
  ServiceManager gone;
  gone.ready();
  gone.alive(now, status);
  ServiceManager none;
  none.ready();
  none.alive(now, status);
  EXPECT_THAT(heard(), IsEmpty());
  EXPECT_FALSE(none.isThere());
}

}  // namespace
}  // namespace palpate
