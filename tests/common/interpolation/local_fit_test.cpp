#include "common/interpolation/local_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace palpate {
namespace {

constexpr double unit = 0.002;  // m per lattice coordinate

/// Of the third degree in the position, metres: E = x^3 + 2 x y z - y^2 z + 3 x^2 + x.
Equilibrium cubic(const Eigen::Vector3d& at) {
  const double x = at.x(), y = at.y(), z = at.z();
  Equilibrium e;
  e.energy = x * x * x + 2 * x * y * z - y * y * z + 3 * x * x + x;
  e.force =
      -Eigen::Vector3d(3 * x * x + 2 * y * z + 6 * x + 1, 2 * x * z - 2 * y * z, 2 * x * y - y * y);
  e.stiffness << 6 * x + 6, 2 * z, 2 * y, 2 * z, -2 * z, 2 * x - 2 * y, 2 * y, 2 * x - 2 * y, 0;
  e.stiffness *= -1;
  return e;
}

/// Solved points at random places around one that is not.
struct SourcesAround {
  explicit SourcesAround(unsigned seed) {
    std::mt19937 random(seed);
    const auto number = [&] { return std::uniform_int_distribution<std::int32_t>(-9, 9)(random); };
    while (offsets.size() < 8) {
      const LatticePoint offset = {number(), number(), number()};
      if (squaredNorm(offset) < 4 || std::ranges::find(offsets, offset) != offsets.end()) continue;
      offsets.push_back(offset);
      data.push_back(cubic(unit * Eigen::Vector3d(offset[0], offset[1], offset[2])));
    }
    for (std::size_t n = 0; n < offsets.size(); ++n) sources.push_back({offsets[n], &data[n]});
  }
  std::vector<LatticePoint> offsets;
  std::vector<Equilibrium> data;
  std::vector<FitSource> sources;
};

TEST(LocalFits, ContinueEnergiesOfTheThirdDegree) {
  LocalFits fits(unit);
  for (unsigned seed = 0; seed < 10; ++seed) {
    const SourcesAround around(seed);
    const Equilibrium there = fits.extrapolate(around.sources, 6, 5).at(Eigen::Vector3d::Zero());
    const Equilibrium expected = cubic(Eigen::Vector3d::Zero());
    EXPECT_NEAR(there.energy, expected.energy, 1e-7);
    EXPECT_LT((there.force - expected.force).norm(), 1e-6);
    EXPECT_LT((there.stiffness - expected.stiffness).norm(), 1e-4);
  }
}

TEST(LocalFits, CompleteASolvedPointByWhatIsAround) {
  LocalFits fits(unit);
  const SourcesAround around(3);
  const LocalPolynomial polynomial =
      fits.complete(cubic(Eigen::Vector3d::Zero()), around.sources, 6);
  const Eigen::Vector3d beside(0.004, -0.002, 0.003);
  EXPECT_NEAR(polynomial.at(beside).energy, cubic(beside).energy, 1e-9);
  EXPECT_LT((polynomial.at(beside).force - cubic(beside).force).norm(), 1e-6);
}

TEST(LocalFits, SayTheSameOfSourcesThatAreRememberedAndForgotten) {
  LocalFits fits(unit);
  const SourcesAround often(0), once(1);
  const auto of = [&](const SourcesAround& around) {
    return fits.extrapolate(around.sources, 6, 5).derivatives;
  };
  const auto of_often = of(often), of_once = of(once);
  // Of some 7600 numbers each: 200 are more than twice what is kept.
  for (unsigned seed = 2; seed < 200; ++seed) {
    of(SourcesAround(seed));
    if (seed % 40 == 0) {
      EXPECT_EQ(of(often), of_often) << seed;
    }
  }
  EXPECT_EQ(of(often), of_often);
  EXPECT_EQ(of(once), of_once);
}

}  // namespace
}  // namespace palpate
