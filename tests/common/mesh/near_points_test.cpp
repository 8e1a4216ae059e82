#include "common/mesh/near_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace palpate {
namespace {

TEST(NearPointsTest, ListsEveryPointWithinReachOfAnyPosition) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-0.1, 0.1);
  const auto draw = [&] { return Eigen::Vector3d(number(random), number(random), number(random)); };
  std::vector<Eigen::Vector3d> points(200);
  std::ranges::generate(points, draw);
  const NearPoints grid(points, 0.03);
  for (int n = 0; n < 300; ++n) {
    const Eigen::Vector3d s = 1.4 * draw();
    const auto near = grid.near(s);
    EXPECT_LT(near.size(), points.size() / 2);
    EXPECT_EQ(grid.isReached(s), std::ranges::any_of(points, [&](const Eigen::Vector3d& point) {
                return (point - s).norm() <= 0.03;
              }));
    for (std::size_t p = 0; p < points.size(); ++p)
      EXPECT_TRUE((points[p] - s).norm() >= 0.03 ||
                  std::ranges::binary_search(near, static_cast<std::int32_t>(p)));
  }
}

TEST(NearPointsTest, ListsNothingFarAwayOrForNaN) {
  const NearPoints grid({Eigen::Vector3d::Zero()}, 0.03);
  EXPECT_FALSE(grid.near({0.01, 0, 0}).empty());
  EXPECT_TRUE(grid.near({1, 0, 0}).empty());
  EXPECT_TRUE(grid.near({NAN, 0, 0}).empty());
  EXPECT_TRUE(grid.isReached({0.01, 0, 0}));
  EXPECT_FALSE(grid.isReached({0.0301, 0, 0}));
}

}  // namespace
}  // namespace palpate
