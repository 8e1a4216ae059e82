#include "common/base/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace palpate {
namespace {

TEST(InParallel, RunsEveryTaskOnce) {
  std::vector<std::atomic<int>> done(1000);
  inParallel(done.size(), [&](std::size_t n) { ++done[n]; });
  for (const std::atomic<int>& times : done) EXPECT_EQ(times, 1);
  inParallel(0, [](std::size_t) { FAIL(); });
}

TEST(InParallel, RethrowsATasksExceptionAfterAllHaveEnded) {
  constexpr int tasks = 10000;
  std::atomic<int> begun = 0, ended = 0;
  EXPECT_THROW(inParallel(tasks,
                          [&](std::size_t n) {
                            ++begun;
                            if (n == 3) {
                              ++ended;
                              throw std::runtime_error("three");
                            }
                            // Sleep, so that the other thread does not finish all tasks before this
                            // one has unwound.
                            if (n > 3) std::this_thread::sleep_for(std::chrono::milliseconds(1));
                            ++ended;
                          }),
               std::runtime_error);
  EXPECT_EQ(begun, ended);
  EXPECT_LT(begun, tasks) << "no further ones begin";
}

TEST(InParallel, RethrowsTheExceptionOfTheLowestNumber) {
  for (int tried = 0; tried < 100; ++tried) try {
      inParallel(100, [](std::size_t n) {
        if (n == 5) std::this_thread::sleep_for(std::chrono::microseconds(100));
        if (n >= 5) throw std::runtime_error(std::to_string(n));
      });
      FAIL();
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(std::string(error.what()), "5");
    }
}

}  // namespace
}  // namespace palpate
