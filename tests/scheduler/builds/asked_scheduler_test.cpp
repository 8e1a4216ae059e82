#include "scheduler/builds/asked_scheduler.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include "scheduler/state/state_directory.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

/// Regression: a scheduler that was reading its journal was treated as absent.
TEST(AskedScheduler, IsReportedAsRunningBeforeItListens) {
  const test::TemporaryDirectory directory;
  Asked asked;
  asked.where = directory.path().string();
  EXPECT_FALSE(schedulerOf(asked));
  {
    const StateDirectory held(directory.path());
    test::expectError(ExitCode::failed, [&] { schedulerOf(asked); },
                      {asked.where, "process " + std::to_string(getpid()), "starting"});
    held.announce({"tcp://127.0.0.1:1234", {}});
    EXPECT_EQ(schedulerOf(asked)->endpoint, "tcp://127.0.0.1:1234");
  }
  {
    const StateDirectory next(directory.path());
    EXPECT_THROW(schedulerOf(asked), NotListening) << "the last one is not queried instead";
  }
  EXPECT_FALSE(schedulerOf(asked));
}

}  // namespace
}  // namespace palpate
