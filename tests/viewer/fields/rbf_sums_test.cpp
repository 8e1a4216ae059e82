#include "viewer/fields/rbf_sums.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>

namespace palpate {
namespace {

using Eigen::Vector3d;

constexpr std::size_t n_blocks = 9;

std::vector<RbfBlock> randomBlocks() {
  std::mt19937 random(5);
  const auto number = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
  std::vector<RbfBlock> blocks(n_blocks);
  for (RbfBlock& block : blocks)
    for (std::size_t l = 0; l < rbf_lanes; ++l)
      for (int i = 0; i < 3; ++i) {
        block.position[i][l] = 3 * number();
        block.weight[i][l] = number();
      }
  return blocks;
}

Vector3d centre(const std::vector<RbfBlock>& blocks, std::size_t n) {
  const auto& position = blocks[n / rbf_lanes].position;
  return {position[0][n % rbf_lanes], position[1][n % rbf_lanes], position[2][n % rbf_lanes]};
}

TEST(RbfSums, EqualThoseOfAPlainLoop) {
  const std::vector<RbfBlock> blocks = randomBlocks();
  for (const int power : {1, 3})
    for (const Vector3d& place :
         {Vector3d(0, 0, 0), Vector3d(0.3, -1.2, 2.4), centre(blocks, 13), Vector3d(40, -7, 3)}) {
      const double p[3] = {place.x(), place.y(), place.z()};
      const RbfSums sums = power == 1 ? linearRbfSums(blocks, p) : cubicRbfSums(blocks, p);
      for (int i = 0; i < 3; ++i) {
        double value = 0, magnitude = 0, slope_magnitude = 0;
        Vector3d gradient = Vector3d::Zero();
        for (std::size_t n = 0; n < n_blocks * rbf_lanes; ++n) {
          const double w = blocks[n / rbf_lanes].weight[i][n % rbf_lanes];
          const Vector3d d = place - centre(blocks, n);
          const double r = d.norm();
          value += w * std::pow(r, power);
          magnitude += std::abs(w * std::pow(r, power));
          if (r > 0) gradient += w * power * std::pow(r, power - 2) * d;
          slope_magnitude += std::abs(w * power * std::pow(r, power - 1));
        }
        EXPECT_NEAR(sums.value[i], value, 1e-12 * magnitude);
        for (int j = 0; j < 3; ++j)
          EXPECT_NEAR(sums.gradient[i][j], gradient[j], 1e-12 * slope_magnitude);
      }
    }
}

TEST(RbfSums, AreZeroWithoutCentres) {
  const RbfSums sums = linearRbfSums({}, {1, 2, 3});
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(sums.value[i], 0);
    for (int j = 0; j < 3; ++j) EXPECT_EQ(sums.gradient[i][j], 0);
  }
}

}  // namespace
}  // namespace palpate
