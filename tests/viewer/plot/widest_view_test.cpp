#include "viewer/plot/widest_view.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(WidestView, IsAlongTheAxisOfTheLeastSpreadFromTheFront) {
  std::vector<Eigen::Vector3d> points;
  for (const double x : {-3.0, 0.0, 3.0})
    for (const double y : {-0.1, 0.1})
      for (const double z : {-2.0, 2.0}) points.emplace_back(x + 7, y, z);
  EXPECT_LT((widestView(points) - Eigen::Vector3d(0, -1, 0)).norm(), 1e-12);
  for (Eigen::Vector3d& point : points) point = point.cwiseProduct(Eigen::Vector3d(1, 50, 0.01));
  EXPECT_NEAR(std::abs(widestView(points).z()), 1, 1e-12);
}

}  // namespace
}  // namespace palpate
