#include "viewer/fields/rbf_kernels.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <random>

namespace palpate {
namespace {

using Eigen::Vector3d;

class EveryRbfFamily : public ::testing::TestWithParam<const RbfKernels*> {
 protected:
  static constexpr std::size_t n_blocks = 9;

  EveryRbfFamily() : rbf(n_blocks), hermite(n_blocks) {
    std::mt19937 random(5);
    const auto number = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
    for (std::size_t n = 0; n < n_blocks; ++n)
      for (std::size_t l = 0; l < rbf_lanes; ++l) {
        for (int i = 0; i < 3; ++i) {
          rbf[n].position[i][l] = hermite[n].position[i][l] = 3 * number();
          rbf[n].weight[i][l] = number();
          hermite[n].b[i][l] = number();
        }
        hermite[n].a[l] = number();
        for (auto& entry : hermite[n].C) entry[l] = number();
      }
  }

  Vector3d centre(std::size_t n) const {
    const auto& position = rbf[n / rbf_lanes].position;
    return {position[0][n % rbf_lanes], position[1][n % rbf_lanes], position[2][n % rbf_lanes]};
  }

  std::vector<Vector3d> places() const {
    return {{0, 0, 0}, {0.3, -1.2, 2.4}, centre(13), {40, -7, 3}};
  }

  std::vector<RbfBlock> rbf;
  std::vector<HermiteBlock> hermite;
  const RbfKernels& kernels = *GetParam();
};
INSTANTIATE_TEST_SUITE_P(RbfKernels, EveryRbfFamily, ::testing::ValuesIn(supportedRbfKernels()),
                         [](const auto& kernels) { return std::string(kernels.param->family); });

TEST_P(EveryRbfFamily, SumsWhatAPlainLoopSums) {
  for (const int power : {1, 3})
    for (const Vector3d& p : places()) {
      RbfSums sums;
      (power == 1 ? kernels.linear : kernels.cubic)(rbf.data(), n_blocks, p.data(), sums);
      for (int i = 0; i < 3; ++i) {
        double value = 0, magnitude = 0, slope_magnitude = 0;
        Vector3d gradient = Vector3d::Zero();
        for (std::size_t n = 0; n < n_blocks * rbf_lanes; ++n) {
          const double w = rbf[n / rbf_lanes].weight[i][n % rbf_lanes];
          const Vector3d d = p - centre(n);
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

/// In extended precision, so that the differences below are good to ten digits.
long double hermiteEnergy(const std::vector<HermiteBlock>& blocks,
                          const std::array<long double, 3>& p) {
  long double total = 0;
  for (const HermiteBlock& block : blocks)
    for (std::size_t l = 0; l < rbf_lanes; ++l) {
      std::array<long double, 3> d;
      long double squared = 0, first = 0, second = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        d[i] = p[i] - block.position[i][l];
        squared += d[i] * d[i];
      }
      const long double r = std::sqrt(squared);
      const std::array<std::array<std::size_t, 3>, 3> voigt = {{{0, 5, 4}, {5, 1, 3}, {4, 3, 2}}};
      for (std::size_t i = 0; i < 3; ++i) {
        first += block.b[i][l] * 7 * std::pow(r, 5.0L) * d[i];
        for (std::size_t j = 0; j < 3; ++j)
          second += block.C[voigt[i][j]][l] *
                    (35 * r * squared * d[i] * d[j] + (i == j ? 7 * r * squared * squared : 0));
      }
      total += block.a[l] * squared * squared * squared * r + first + second;
    }
  return total;
}

TEST_P(EveryRbfFamily, DifferentiatesItsHermiteSum) {
  const long double step = 1e-4;
  for (const Vector3d& p : places()) {
    HermiteSums sums;
    kernels.hermite(hermite.data(), n_blocks, p.data(), sums);
    const auto energy = [&](int i, int sign_i, int j, int sign_j) {
      std::array<long double, 3> at = {p.x(), p.y(), p.z()};
      at[static_cast<std::size_t>(i)] += sign_i * step;
      at[static_cast<std::size_t>(j)] += sign_j * step;
      return hermiteEnergy(hermite, at);
    };
    const long double here = energy(0, 0, 0, 0);
    EXPECT_NEAR(sums.value, static_cast<double>(here), 1e-12 * (1 + std::abs(sums.value)));
    const int row[6] = {0, 1, 2, 1, 0, 0}, column[6] = {0, 1, 2, 2, 2, 1};
    const double scale = std::pow(p.norm() + 5, 7);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(sums.gradient[i],
                  static_cast<double>((energy(i, 1, i, 0) - energy(i, -1, i, 0)) / (2 * step)),
                  1e-8 * scale);
    for (int v = 0; v < 6; ++v) {
      const int i = row[v], j = column[v];
      const long double difference = i == j ? energy(i, 1, i, 0) - 2 * here + energy(i, -1, i, 0)
                                            : (energy(i, 1, j, 1) - energy(i, 1, j, -1) -
                                               energy(i, -1, j, 1) + energy(i, -1, j, -1)) /
                                                  4;
      EXPECT_NEAR(sums.hessian[v], static_cast<double>(difference / (step * step)), 1e-7 * scale);
    }
  }
}

TEST_P(EveryRbfFamily, AgreesWithTheBaselineOnHermiteSums) {
  const RbfKernels& baseline = *supportedRbfKernels().back();
  for (const Vector3d& p : places()) {
    HermiteSums sums, expected;
    kernels.hermite(hermite.data(), n_blocks, p.data(), sums);
    baseline.hermite(hermite.data(), n_blocks, p.data(), expected);
    const double scale = std::pow(p.norm() + 5, 7);
    EXPECT_NEAR(sums.value, expected.value, 1e-12 * scale);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(sums.gradient[i], expected.gradient[i], 1e-12 * scale);
    for (int v = 0; v < 6; ++v) EXPECT_NEAR(sums.hessian[v], expected.hessian[v], 1e-12 * scale);
  }
}

TEST_P(EveryRbfFamily, OfNothingIsZero) {
  const Vector3d p(1, 2, 3);
  RbfSums sums{{1, 1, 1}, {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}};
  kernels.cubic(nullptr, 0, p.data(), sums);
  EXPECT_EQ(sums.value[0], 0);
  EXPECT_EQ(sums.gradient[2][1], 0);
}

}  // namespace
}  // namespace palpate
