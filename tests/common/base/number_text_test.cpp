#include "common/base/number_text.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(NumberText, ASingleItemHasNoPlural) {
  EXPECT_EQ(counted(1, "node"), "1 node");
  EXPECT_EQ(counted(std::size_t{0}, "node"), "0 nodes");
  EXPECT_EQ(counted(280, "site"), "280 sites");
  EXPECT_EQ(counted(1, "tetrahedron", "tetrahedra"), "1 tetrahedron");
  EXPECT_EQ(counted(2, "tetrahedron", "tetrahedra"), "2 tetrahedra");
}

TEST(NumberText, ZeroHasNoSign) {
  EXPECT_EQ(vectorText({0.00249, -0.0, -0.000171}, 3, " "), "0.00249 0 -0.000171");
  EXPECT_EQ(vectorText({-0.0, 1234.5678, 1e-9}, 4), "0, 1235, 1e-09");
}

}  // namespace
}  // namespace palpate
