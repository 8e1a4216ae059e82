#include "scheduler/service/pace.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

using namespace std::chrono_literals;

TEST(Pace, IsZeroAtTheStart) {
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

/// A build of 100 s whose estimates are too small by this factor.
double lastFactor(double too_small) {
  Hindsight hindsight;
  for (double worked = 0.5; worked < 80; worked += 0.5)
    hindsight.note(worked, (100 - worked) / too_small);
  return hindsight.factor(80, 20 / too_small);
}

TEST(Hindsight, KeepsEstimatesThatWereNearlyRight) {
  EXPECT_EQ(lastFactor(1), 1);
  EXPECT_EQ(lastFactor(1.5), 1);
}

TEST(Hindsight, LengthensEstimatesThatWereTooSmall) {
  EXPECT_GT(lastFactor(4), 1.8);
  EXPECT_LT(lastFactor(4), 2.3);
  EXPECT_EQ(lastFactor(20), 4) << "no more than four times";
}

TEST(Hindsight, NeverShortensAnEstimate) { EXPECT_EQ(lastFactor(0.5), 1); }

TEST(Hindsight, DoesNotCorrectBeforeItHasAnEarlierEstimate) {
  Hindsight hindsight;
  EXPECT_EQ(hindsight.factor(1, 10), 1);
  hindsight.note(1, 10);
  EXPECT_EQ(hindsight.factor(1, 10), 1);
  hindsight.note(1.2, 0);
  EXPECT_EQ(hindsight.factor(2, 0), 1);
}

}  // namespace
}  // namespace palpate
