#include "common/base/printable.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(Printable, MovesNoCursorAndBeginsNoLine) {
  EXPECT_EQ(printable("node-17"), "node-17");
  EXPECT_EQ(printable("\x1b[2Jall is\nwell\x7f\xff"), "?[2Jall is?well??");
  EXPECT_EQ(printable(std::string(1000, 'x')), std::string(64, 'x'));
  EXPECT_EQ(printable(std::string(1000, 'x'), 3), "xxx");
}

}  // namespace
}  // namespace palpate
