#include "viewer/export/touch_way.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

using test::expectBadInput;
using Words = std::vector<std::string>;

constexpr double radius = 0.02;

std::vector<WayStep> wayOf(const Words& displacement, int steps, const std::string& lines = "",
                           const Words& at = {}) {
  std::istringstream input(lines);
  return touchWay(at, displacement, steps, input, radius);
}

TEST(TouchWay, GoesStraightFromRestToTheDisplacement) {
  const auto way = wayOf({"0.003", "0", "-0.004"}, 5);
  ASSERT_EQ(way.size(), 6U);
  EXPECT_TRUE(way.front().touch.displacement.isZero(0));
  EXPECT_EQ(way.back().touch.displacement, Eigen::Vector3d(0.003, 0, -0.004));
  for (std::size_t n = 0; n < way.size(); ++n)
    EXPECT_NEAR(way[n].way, 0.001 * static_cast<double>(n), 1e-15);
}

TEST(TouchWay, OfTheInputIsAsLongAsTheToolGoes) {
  const auto way = wayOf({"-"}, 0, "0.001 0 0\n0.001 0 0.002\n# nothing\n0.001 0 0\n");
  ASSERT_EQ(way.size(), 3U);
  EXPECT_EQ(way[0].way, 0) << "begins where the first is";
  EXPECT_DOUBLE_EQ(way[1].way, 0.002);
  EXPECT_DOUBLE_EQ(way[2].way, 0.004);
}

TEST(TouchWay, OfAFingerThatSlidesIsAsLongAsTheToolGoes) {
  const auto way = wayOf({"-"}, 0, "0 0 0.1 0 0 -0.001\n0.003 0 0.1 0 0 -0.005\n", {"-"});
  ASSERT_EQ(way.size(), 2U);
  EXPECT_EQ(way[1].touch.at, Eigen::Vector3d(0.003, 0, 0.1));
  EXPECT_DOUBLE_EQ(way[1].way, 0.005);
}

TEST(TouchWay, HasSteps) {
  for (const int steps : {0, -3, most_steps + 1})
    expectBadInput(
        [&] {
          wayOf({"0.01", "0", "0"}, steps);
        },
        {"--steps " + std::to_string(steps), "1 to 100000"});
  expectBadInput([&] { wayOf({"-"}, 4, "0 0 0\n"); }, {"--steps 4", "every line"});
  expectBadInput([&] { wayOf({"-"}, 0, "# nothing\n"); }, {"standard input", "no displacement"});
  expectBadInput([&] { wayOf({"-"}, 0, "0 0 0\n0 0\n"); }, {"standard input, line 2"});
}

}  // namespace
}  // namespace palpate
