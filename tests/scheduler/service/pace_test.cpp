#include "scheduler/service/pace.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

using namespace std::chrono_literals;

TEST(Pace, IsNothingAtTheStart) {
  const auto now = std::chrono::steady_clock::now();
  EXPECT_EQ(Pace(now).perSecond(now, 0), 0);
}

TEST(Pace, FollowsAChangeWithinTwoMinutes) {
  const auto start = std::chrono::steady_clock::now();
  Pace pace(start);
  std::int64_t found = 0;
  for (int second = 1; second <= 600; ++second)
    pace.note(start + std::chrono::seconds(second), found += 10);
  EXPECT_DOUBLE_EQ(pace.perSecond(start + 600s, found), 10);
  for (int second = 601; second <= 721; ++second)
    pace.note(start + std::chrono::seconds(second), ++found);
  EXPECT_NEAR(pace.perSecond(start + 721s, found), 1, 0.1);
}

}  // namespace
}  // namespace palpate
