#include "common/interpolation/local_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace palpate {
namespace {

constexpr double unit = 0.002;  // m per lattice coordinate

/// A cubic energy of the position in metres: E = x^3 + 2 x y z - y^2 z + 3 x^2 + x.
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

/// Solved points at random places around an unsolved one.
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

TEST(LocalFits, CompleteASolvedPointFromItsNeighbours) {
  LocalFits fits(unit);
  const SourcesAround around(3);
  const LocalPolynomial polynomial =
      fits.complete(cubic(Eigen::Vector3d::Zero()), around.sources, 6);
  const Eigen::Vector3d beside(0.004, -0.002, 0.003);
  EXPECT_NEAR(polynomial.at(beside).energy, cubic(beside).energy, 1e-9);
  EXPECT_LT((polynomial.at(beside).force - cubic(beside).force).norm(), 1e-6);
}

TEST(LocalFits, GiveTheSameResultForCachedAndForgottenSources) {
  LocalFits fits(unit);
  const SourcesAround often(0), once(1);
  const auto of = [&](const SourcesAround& around) {
    return fits.extrapolate(around.sources, 6, 5).derivatives;
  };
  const auto of_often = of(often), of_once = of(once);
  // Each factorisation has about 7600 numbers, so 200 of them exceed the size of the cache.
  for (unsigned seed = 2; seed < 200; ++seed) {
    of(SourcesAround(seed));
    if (seed % 40 == 0) {
      EXPECT_EQ(of(often), of_often) << seed;
    }
  }
  EXPECT_EQ(of(often), of_often);
  EXPECT_EQ(of(once), of_once);
}

/// The same energy at a point and six neighbours, with all third derivatives.
struct KnownToTheThirdOrder {
  KnownToTheThirdOrder() {
    const std::array<LatticePoint, 6> offsets = {
        {{6, 0, 0}, {-6, 0, 0}, {0, 6, 0}, {0, -6, 0}, {0, 0, 6}, {0, 0, -6}}};
    for (std::size_t n = 0; n < offsets.size(); ++n) {
      const LatticePoint& o = offsets[n];
      data[n] = completely(unit * Eigen::Vector3d(o[0], o[1], o[2]));
      sources.push_back({o, &data[n]});
    }
    own = completely(Eigen::Vector3d::Zero());
  }
  static Equilibrium completely(const Eigen::Vector3d& at) {
    Equilibrium e = cubic(at);
    // Rows xx, xy, xz, yy, yz, zz.
    e.stiffness_by_p << -6, 0, 0, 0, 0, -2, 0, -2, 0, 0, 0, 2, -2, 2, 0, 0, 0, 0;
    return e;
  }
  Equilibrium own;
  std::array<Equilibrium, 6> data;
  std::vector<FitSource> sources;
};

TEST(LocalFits, JudgeThirdDerivativesByTheStiffnessesAround) {
  KnownToTheThirdOrder around;
  const LocalFits fits(unit, finger_fit);
  EXPECT_EQ(fits.judge(around.own, around.sources), KnownOrders::third);
  around.own.stiffness_by_p *= 1.9;
  EXPECT_EQ(fits.judge(around.own, around.sources), KnownOrders::third) << "better than no fit";
  around.own.stiffness_by_p *= 1.1;
  EXPECT_EQ(fits.judge(around.own, around.sources), KnownOrders::curvature);
  around.own.stiffness_by_p.setZero();
  EXPECT_EQ(fits.judge(around.own, around.sources), KnownOrders::third)
      << "the fit explains nothing";
}

TEST(LocalFits, JudgeCurvaturesByTheSlopesAround) {
  KnownToTheThirdOrder around;
  const LocalFits fits(unit, finger_drive_fit);
  EXPECT_EQ(fits.judge(around.own, around.sources), KnownOrders::curvature);
  around.own.stiffness *= -1;
  EXPECT_EQ(fits.judge(around.own, around.sources), KnownOrders::slope);
}

TEST(LocalFits, JudgeSlopesByTheValuesAroundWhenFarOff) {
  KnownToTheThirdOrder around;
  const LocalFits fits(unit, finger_slope_fit);
  EXPECT_EQ(fits.judge(around.own, around.sources), KnownOrders::slope);
  around.own.force *= 3;
  EXPECT_EQ(fits.judge(around.own, around.sources), KnownOrders::slope) << "of coarse cells";
  around.own.force *= 10;
  EXPECT_EQ(fits.judge(around.own, around.sources), KnownOrders::value);
}

TEST(LocalFits, ReplaceDerivativesThatDoNotCount) {
  KnownToTheThirdOrder around;
  LocalFits fits(unit, finger_fit);
  const Eigen::Vector3d beside(0.004, -0.002, 0.003);
  const auto expectRight = [&](const LocalPolynomial& polynomial) {
    EXPECT_NEAR(polynomial.at(beside).energy, cubic(beside).energy, 1e-9);
    EXPECT_LT((polynomial.at(beside).force - cubic(beside).force).norm(), 1e-5);
  };
  expectRight(fits.complete(around.own, around.sources, 6));
  around.own.stiffness_by_p.setConstant(1e6);
  expectRight(fits.complete(around.own, around.sources, 6, KnownOrders::curvature));
  around.data[2].stiffness_by_p.setConstant(1e6);
  around.sources[2].known = KnownOrders::curvature;
  expectRight(fits.complete(around.own, around.sources, 6, KnownOrders::curvature));
  around.sources.erase(around.sources.begin() + 4, around.sources.end());
  expectRight(fits.extrapolate(around.sources, 6, 4));
}

TEST(LocalFits, StayFiniteIfAnOrderIsUnknownEverywhere) {
  KnownToTheThirdOrder around;
  LocalFits fits(unit, finger_drive_fit);
  around.sources.resize(1);
  around.sources[0].known = KnownOrders::slope;
  const Eigen::Vector3d beside(0.004, -0.002, 0.003);
  EXPECT_LT(
      fits.complete(around.own, around.sources, 6, KnownOrders::slope).at(beside).force.norm(),
      10 * cubic(beside).force.norm());
}

}  // namespace
}  // namespace palpate
