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

TEST(NumberIn, IsFoundBetweenPrefixAndSuffix) {
  EXPECT_EQ(numberBetween<int>("a-", "a-0012.b", ".b"), 12);
  for (const char* none : {"a-.b", "a-1", "1.b", "a-1x.b", "a-+1.b", "xa-1.b", "a-1.bx", ""})
    EXPECT_FALSE(numberBetween<int>("a-", none, ".b")) << none;
  EXPECT_FALSE(numberBetween<int>("1.", "1.1", ".1"));
}

}  // namespace
}  // namespace palpate
