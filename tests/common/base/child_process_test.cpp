#include "common/base/child_process.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <thread>

namespace palpate {
namespace {

using std::chrono::milliseconds;

std::string howItEnds(std::vector<std::string> words) {
  ChildProcess child(std::move(words));
  while (child.running()) std::this_thread::sleep_for(milliseconds(1));
  return child.how();
}

TEST(ChildProcess, SaysHowItEnded) {
  EXPECT_EQ(howItEnds({"/bin/sh", "-c", "exit 7"}), "exit code 7");
  EXPECT_EQ(howItEnds({"/bin/sh", "-c", "kill -9 $$"}), "signal 9 (Killed)");
  EXPECT_EQ(howItEnds({"/nowhere/palpate-worker"}), "exit code 127");
}

TEST(ChildProcess, IsKilledIfItIgnoresTerminationForTheGracePeriod) {
  // If this process could not be killed, the test would not end.
  ChildProcess child({"/bin/sh", "-c", "trap '' TERM; while :; do sleep 0.01; done"});
  std::this_thread::sleep_for(milliseconds(100));
  child.terminate(milliseconds(50));
  EXPECT_FALSE(child.running());
  EXPECT_EQ(child.signal(), SIGKILL);
}

TEST(ChildProcess, LeavesNoProcessBehind) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  { ChildProcess child({"/bin/sleep", "600"}); }
  close(ends[1]);
  // All holders of the other end are gone, so the read ends.
  char byte = 0;
  EXPECT_EQ(read(ends[0], &byte, 1), 0);
  close(ends[0]);
}

}  // namespace
}  // namespace palpate
