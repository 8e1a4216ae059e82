#pragma once

#include <Eigen/Core>
#include <random>
#include <vector>

namespace palpate::test {

/// Radius of the workspaces for tests of fields, metres.
inline constexpr double radius = 0.02;

/// Points in the ball of radius `reach` (m), the same in every run.
inline std::vector<Eigen::Vector3d> pointsInBall(double reach, int count = 300) {
  std::mt19937 random(23);
  const auto coordinate = [&] {
    return reach * (static_cast<double>(random()) / 2147483648.0 - 1);
  };
  std::vector<Eigen::Vector3d> points;
  while (static_cast<int>(points.size()) < count) {
    const double x = coordinate(), y = coordinate(), z = coordinate();
    if (const Eigen::Vector3d p(x, y, z); p.norm() <= reach) points.push_back(p);
  }
  return points;
}

}  // namespace palpate::test
