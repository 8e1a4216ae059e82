#include "common/base/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace palpate {
namespace {

TEST(InParallel, DoesEveryTaskOnce) {
  std::vector<std::atomic<int>> done(1000);
  inParallel(done.size(), [&](std::size_t n) { ++done[n]; });
  for (const std::atomic<int>& times : done) EXPECT_EQ(times, 1);
  inParallel(0, [](std::size_t) { FAIL(); });
}

TEST(InParallel, ThrowsWhatATaskThrewWhenAllHaveEnded) {
  std::atomic<int> begun = 0, ended = 0;
  EXPECT_THROW(inParallel(100000,
                          [&](std::size_t n) {
                            ++begun;
                            if (n == 3) {
                              ++ended;
                              throw std::runtime_error("three");
                            }
                            ++ended;
                          }),
               std::runtime_error);
  EXPECT_EQ(begun, ended);
  EXPECT_LT(begun, 100000) << "no further ones begin";
}

}  // namespace
}  // namespace palpate
