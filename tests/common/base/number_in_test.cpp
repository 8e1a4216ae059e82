#include "common/base/number_in.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace palpate {
namespace {

TEST(NumberIn, ReadsOnlyCompletelyNumericText) {
  EXPECT_EQ(numberIn<int>("-17"), -17);
  EXPECT_EQ(numberIn<double>("2.5"), 2.5);
  EXPECT_EQ(numberIn<std::uint16_t>("65535"), 65535);
  for (const char* none : {"", " 1", "1 ", "+1", "1.5", "0x1", "one"})
    EXPECT_FALSE(numberIn<int>(none)) << none;
  EXPECT_FALSE(numberIn<std::uint16_t>("65536"));
  EXPECT_FALSE(numberIn<std::uint16_t>("-1"));
}

}  // namespace
}  // namespace palpate
