#include "common/base/thread_pool.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <barrier>

namespace palpate {
namespace {

TEST(ThreadPool, RunsEveryTaskOnceInEveryCall) {
  ThreadPool pool(3);
  std::vector<std::atomic<int>> done(100);
  for (int round = 1; round <= 2000; ++round) {
    pool.run(done.size(), [&](std::size_t n) { ++done[n]; });
    for (const std::atomic<int>& times : done) ASSERT_EQ(times, round);
  }
  pool.run(0, [](std::size_t) { FAIL(); });
}

TEST(ThreadPool, UsesItsThreads) {
  ThreadPool pool(2);
  // Each task waits for the other, so one thread alone cannot end them.
  std::barrier together(2);
  pool.run(2, [&](std::size_t) { together.arrive_and_wait(); });
}

TEST(ThreadPool, WorksInAForkedChildWithoutItsThreads) {
  auto pool = std::make_unique<ThreadPool>(3);
  pool->run(10, [](std::size_t) {});
  const pid_t child = fork();
  if (child == 0) {
    std::atomic<int> done = 0;
    pool->run(10, [&](std::size_t) { ++done; });
    pool.reset();
    _exit(done == 10 ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace palpate
