#include "viewer/plot/round_numbers.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(RoundNumbers, AreOneTwoOrFiveTimesAPowerOfTen) {
  EXPECT_DOUBLE_EQ(roundUp(0.011), 0.02);
  EXPECT_DOUBLE_EQ(roundUp(0.021), 0.05);
  EXPECT_DOUBLE_EQ(roundUp(0.051), 0.1);
  EXPECT_DOUBLE_EQ(roundUp(7), 10);
  EXPECT_DOUBLE_EQ(roundUp(1234), 2000);
}

TEST(RoundNumbers, KeepRoundNumbersUpToRounding) {
  for (const double round : {1e-3, 2e-3, 5e-3, 0.1, 0.2, 0.5, 1.0, 20.0, 5000.0}) {
    EXPECT_DOUBLE_EQ(roundUp(round), round);
    EXPECT_DOUBLE_EQ(roundUp(round * (1 + 1e-12)), round);
  }
  EXPECT_DOUBLE_EQ(roundUp(0.3 / 3), 0.1);
}

}  // namespace
}  // namespace palpate
