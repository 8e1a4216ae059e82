#include "viewer/fields/jet_sums.hpp"

#include <gtest/gtest.h>

#include <random>

namespace palpate {
namespace {

struct JetSumsOfALeaf : ::testing::Test {
  JetSumsOfALeaf() {
    for (auto& collocation_point : collocation_points)
      for (SiteJet& jet : collocation_point)
        jet = SiteJet::NullaryExpr([this] { return static_cast<float>(number()); });
    sums.begin(basis);
  }
  double number() { return std::uniform_real_distribution<double>(-1, 1)(random); }
  /// Adds the jets times the factors to `sums`.
  JetSums::Quantities add(const std::array<SiteJet, 8>& jets, const JetSums::Quantities& factors) {
    std::array<PackedJet, 8> packed;
    std::array<const PackedJet*, 8> pointers;
    for (std::size_t c = 0; c < 8; ++c) {
      packed[c] = PackedJet(jets[c]);
      pointers[c] = &packed[c];
    }
    return sums.add(pointers, factors);
  }
  std::array<EnergyJet, 8> dividedBy(double divisor) const {
    std::array<EnergyJet, 8> quotients;
    sums.divide(divisor, quotients);
    return quotients;
  }

  std::mt19937 random{11};
  std::array<std::array<SiteJet, 8>, 3> collocation_points;
  const LeafBasis basis = valueBasis(0.5, 1, {0.3, 0.8, 0.1});
  JetSums sums;
};

TEST_F(JetSumsOfALeaf, EqualTheSumsOverQuantitiesAndCollocationPoints) {
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(27, 8);
  for (const auto& collocation_point : collocation_points) {
    const JetSums::Quantities factors =
        JetSums::Quantities::NullaryExpr([this] { return static_cast<float>(number()); });
    for (int c = 0; c < 8; ++c)
      expected.col(c) +=
          collocation_point[at(c)].topRows<27>().cast<double>() * factors.cast<double>();
    add(collocation_point, factors);
  }
  for (int c = 0; c < 8; ++c)
    for (int n = 0; n < 27; ++n) EXPECT_NEAR(dividedBy(2)[at(c)][at(n)], expected(n, c) / 2, 1e-5);
}

TEST_F(JetSumsOfALeaf, GiveTheQuantitiesAtThePlace) {
  for (const auto& collocation_point : collocation_points) {
    const JetSums::Quantities values = add(collocation_point, JetSums::Quantities::Ones());
    for (int q = 0; q < place_quantities; ++q) {
      double expected = 0;
      for (int c = 0; c < 8; ++c)
        for (int n = 0; n < 27; ++n)
          expected += basis[at(c)][at(n)] * static_cast<double>(collocation_point[at(c)](n, q));
      EXPECT_NEAR(values[q], expected, 1e-5);
    }
  }
}

TEST_F(JetSumsOfALeaf, AreClearedByBegin) {
  add(collocation_points[0], JetSums::Quantities::Ones());
  sums.begin(basis);
  for (std::size_t c = 0; c < 8; ++c)
    for (std::size_t n = 0; n < 27; ++n) EXPECT_EQ(dividedBy(1)[c][n], 0);
}

}  // namespace
}  // namespace palpate
