// Packs stay within this file.
#pragma GCC diagnostic ignored "-Wpsabi"

#include "worker/elements/point_response.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::kernels_default {
namespace {

TEST(PointResponse, RootsOfAllLanesAreAccurateToTwoUlp) {
  for (int n = 0; n < 2000; ++n) {
    Pack J;
    for (int lane = 0; lane < lanes; ++lane)
      J[lane] = (n % 2 ? 1 : -1) * std::exp(0.01 * (n - 1000) + lane);
    const Pack result = inverseTwoThirds(J);
    for (int lane = 0; lane < lanes; ++lane) {
      const long double root = std::cbrt(static_cast<long double>(J[lane]));
      const long double exact = 1 / (root * root);
      ASSERT_LT(std::abs(result[lane] - exact), 4e-16L * exact) << "J = " << J[lane];
    }
  }
}

TEST(PointResponse, IsExactAtRest) {
  const Pack result = inverseTwoThirds(Pack{} + 1.0);
  for (int lane = 0; lane < lanes; ++lane) EXPECT_EQ(result[lane], 1);
}

TEST(PointResponse, IsNaNForInvertedElementsUnderALogarithmicLaw) {
  ElementParameters parameters;
  parameters.law = LawName::neo_hookean;
  parameters.mu = 1000;
  parameters.bulk = 1e5;
  Strain<Pack> strain{};
  strain.J += -0.5;
  Response response;
  respond<false>(parameters, BatchGeometry{}, Pack{}, strain, response);
  EXPECT_TRUE(std::isnan(response.energy[0]));
  EXPECT_TRUE(std::isnan(response.S[0][0]));
}

}  // namespace
}  // namespace palpate::kernels_default
