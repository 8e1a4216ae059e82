#include "scheduler/fleet/worker_pool.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <thread>

namespace palpate {
namespace {

using std::chrono::milliseconds;

/// Waits for all processes to end and returns them.
std::vector<WorkerPool::Ended> allThatEnd(WorkerPool& pool) {
  std::vector<WorkerPool::Ended> all;
  while (pool.running() > 0) {
    for (const WorkerPool::Ended& ended : pool.reap()) all.push_back(ended);
    std::this_thread::sleep_for(milliseconds(1));
  }
  return all;
}

TEST(WorkerPool, ReportsHowEachProcessEnded) {
  WorkerPool failing({"/bin/sh", "-c", "exit 7"}), killed({"/bin/sh", "-c", "kill -9 $$"}),
      missing({"/nowhere/palpate-worker"});
  for (WorkerPool* pool : {&failing, &killed, &missing}) pool->start();
  failing.start();
  const auto two = allThatEnd(failing);
  ASSERT_EQ(two.size(), 2U);
  EXPECT_NE(two[0].pid, two[1].pid);
  EXPECT_EQ(two[0].how, "exit code 7");
  EXPECT_EQ(allThatEnd(killed).at(0).how, "signal 9 (Killed)");
  EXPECT_EQ(allThatEnd(missing).at(0).how, "exit code 127");
}

TEST(WorkerPool, KillsProcessesThatIgnoreTerminationAfterTheGracePeriod) {
  // If this process could not be killed, the test would not end.
  WorkerPool pool({"/bin/sh", "-c", "trap '' TERM; while :; do sleep 0.01; done"});
  pool.start();
  std::this_thread::sleep_for(milliseconds(100));
  pool.terminate(milliseconds(50));
  EXPECT_EQ(pool.running(), 0U);
}

TEST(WorkerPool, LeavesNoProcessBehind) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  {
    WorkerPool pool({"/bin/sleep", "600"});
    pool.start();
  }
  close(ends[1]);
  // All holders of the other end are gone, so the read ends.
  char byte = 0;
  EXPECT_EQ(read(ends[0], &byte, 1), 0);
  close(ends[0]);
}

}  // namespace
}  // namespace palpate
