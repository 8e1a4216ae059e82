#include "worker/laws.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

namespace palpate::kernels_default {
namespace {

/// Voigt strain (engineering shear) of a random deformation gradient near the identity, fixed seed.
class LawTest : public ::testing::Test {
 protected:
  void drawStrain(double size) {
    std::uniform_real_distribution<double> uniform(-size, size);
    for (double& component : e_) component = uniform(random_);
  }

  static Strain<double> strainOf(const double (&e)[6]) {
    Strain<double> strain{};
    Eigen::Matrix3d C;
    for (int v = 0; v < 6; ++v) {
      strain.e[v] = e[v];
      const int I = voigt_row[v], K = voigt_column[v];
      C(I, K) = C(K, I) = (I == K ? 1.0 + 2 * e[v] : e[v]);
    }
    const Eigen::Matrix3d inverse = C.inverse();
    for (int v = 0; v < 6; ++v) strain.C_inverse[v] = inverse(voigt_row[v], voigt_column[v]);
    strain.J = std::sqrt(C.determinant());
    return strain;
  }

  template <class Law>
  static double energy(const Law& law, const double (&e)[6]) {
    double W, S[6];
    law.evaluate(strainOf(e), W, S);
    return W;
  }

  /// Stress against differences of the energy, tangent against differences of the stress.
  template <class Law>
  void expectConsistent(const Law& law, double modulus) {
    constexpr double h = 1e-5;
    for (int round = 0; round < 20; ++round) {
      drawStrain(0.15);
      double W, S[6], D[6][6];
      law.evaluate(strainOf(e_), W, S);
      law.tangent(strainOf(e_), D);
      for (int j = 0; j < 6; ++j) {
        double up[6], down[6], S_up[6], S_down[6], W_up, W_down;
        std::copy(e_, e_ + 6, up);
        std::copy(e_, e_ + 6, down);
        up[j] += h;
        down[j] -= h;
        law.evaluate(strainOf(up), W_up, S_up);
        law.evaluate(strainOf(down), W_down, S_down);
        EXPECT_NEAR((W_up - W_down) / (2 * h), S[j], 1e-7 * modulus) << "stress component " << j;
        for (int i = 0; i < 6; ++i)
          EXPECT_NEAR((S_up[i] - S_down[i]) / (2 * h), D[i][j], 1e-6 * modulus)
              << "tangent " << i << "," << j;
      }
    }
  }

  std::mt19937 random_{7};
  double e_[6] = {};
};

TEST_F(LawTest, StVenantKirchhoffStressAndTangentAreDerivativesOfItsEnergy) {
  expectConsistent(StVenantKirchhoff{254537, 5194.6}, 1e6);
}

TEST_F(LawTest, MooneyRivlinStressAndTangentAreDerivativesOfItsEnergy) {
  expectConsistent(MooneyRivlin{1300, 1280}, 1e4);
}

TEST_F(LawTest, MooneyRivlinIsThePapersEnergyWithoutItsMisprintWhereVolumeIsKept) {
  const MooneyRivlin law{1300, 1280};
  for (int round = 0; round < 20; ++round) {
    drawStrain(0.1);
    // Scale the deformation to det F = 1.
    const double scale = std::pow(strainOf(e_).J, -2.0 / 3);
    for (int v = 0; v < 6; ++v) e_[v] = v < 3 ? (scale * (1 + 2 * e_[v]) - 1) / 2 : scale * e_[v];
    ASSERT_NEAR(strainOf(e_).J, 1, 1e-12);
    const double trace = e_[0] + e_[1] + e_[2];
    const double squares =
        e_[0] * e_[0] + e_[1] * e_[1] + e_[2] * e_[2] + (e_[3] * e_[3] + e_[4] * e_[4] + e_[5] * e_[5]) / 2;
    const double paper = 2 * ((1300 + 2 * 1280) * trace + 1280 * (trace * trace - squares));
    EXPECT_NEAR(energy(law, e_), paper, 1e-8);
  }
}

TEST_F(LawTest, EveryLawIsFreeOfStressAtRest) {
  const double rest[6] = {};
  double W, S[6];
  const auto expectNothing = [&] {
    EXPECT_NEAR(W, 0, 1e-9);
    for (const double component : S) EXPECT_NEAR(component, 0, 1e-9);
  };
  StVenantKirchhoff{254537, 5194.6}.evaluate(strainOf(rest), W, S);
  expectNothing();
  MooneyRivlin{1300, 1280}.evaluate(strainOf(rest), W, S);
  expectNothing();
}

}  // namespace
}  // namespace palpate::kernels_default
