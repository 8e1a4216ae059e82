#include "worker/elements/shape_functions.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::kernels_default {
namespace {

double factorial(int n) { return std::tgamma(n + 1.0); }

/// The mean of x_0^i x_1^j x_2^k x_3^l over the tetrahedron.
double meanOfMonomial(int i, int j, int k, int l) {
  return 6 * factorial(i) * factorial(j) * factorial(k) * factorial(l) /
         factorial(i + j + k + l + 3);
}

template <int n>
double byRule(const QuadratureRule<n>& rule, int i, int j, int k, int l) {
  double sum = 0;
  for (int point = 0; point < n; ++point) {
    const double(&x)[4] = rule.point[point];
    sum += rule.weight[point] * std::pow(x[0], i) * std::pow(x[1], j) * std::pow(x[2], k) *
           std::pow(x[3], l);
  }
  return sum;
}

/// Largest error of a rule over all monomials of this degree.
template <int n>
double worstError(const QuadratureRule<n>& rule, int degree) {
  double worst = 0;
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; i + j <= degree; ++j)
      for (int k = 0; i + j + k <= degree; ++k) {
        const int l = degree - i - j - k;
        worst = std::max(worst, std::abs(byRule(rule, i, j, k, l) - meanOfMonomial(i, j, k, l)));
      }
  return worst;
}

TEST(Quadrature, PointsLieInTheTetrahedron) {
  for (const auto& x : degree_5_rule.point) {
    EXPECT_NEAR(x[0] + x[1] + x[2] + x[3], 1, 1e-15);
    for (const double coordinate : x) EXPECT_GT(coordinate, 0);
  }
}

TEST(Quadrature, IsExactUpToItsDegreeAndNotBeyond) {
  for (const int degree : {0, 1}) EXPECT_LT(worstError(centroid_rule, degree), 1e-15);
  EXPECT_GT(worstError(centroid_rule, 2), 1e-3);
  for (const int degree : {0, 1, 2, 3, 4, 5})
    EXPECT_LT(worstError(degree_5_rule, degree), 1e-15) << degree;
  EXPECT_GT(worstError(degree_5_rule, 6), 1e-5);
}

/// The barycentric coordinates of node a.
template <class Space>
void place(int a, double (&x)[4]) {
  for (double& coordinate : x) coordinate = 0;
  for (const int end : Space::end[a]) x[end] += 1.0 / Space::ends;
}

template <class Space>
class ShapeFunctions : public ::testing::Test {};
using Spaces = ::testing::Types<P1, P2>;
TYPED_TEST_SUITE(ShapeFunctions, Spaces);

TYPED_TEST(ShapeFunctions, AreOneAtTheirNodeAndZeroAtTheOthers) {
  for (int b = 0; b < TypeParam::nodes; ++b) {
    double x[4];
    place<TypeParam>(b, x);
    for (int a = 0; a < TypeParam::nodes; ++a) EXPECT_EQ(TypeParam::value(a, x), a == b ? 1 : 0);
  }
}

TYPED_TEST(ShapeFunctions, HaveTheGradientsOfTheirValues) {
  const double x[4] = {0.1, 0.25, 0.4, 0.25};
  constexpr double h = 1e-6;
  // Along an edge of the tetrahedron, from vertex `from` to vertex `to`.
  for (int from = 0; from < 4; ++from)
    for (int to = 0; to < 4; ++to)
      for (int a = 0; a < TypeParam::nodes; ++a) {
        double up[4], down[4], slope = 0;
        for (int b = 0; b < 4; ++b) {
          const double direction = (b == to ? 1 : 0) - (b == from ? 1 : 0);
          up[b] = x[b] + h * direction;
          down[b] = x[b] - h * direction;
        }
        for (int e = 0; e < TypeParam::ends; ++e) {
          if (TypeParam::end[a][e] == to) slope += TypeParam::slope(a, e, x);
          if (TypeParam::end[a][e] == from) slope -= TypeParam::slope(a, e, x);
        }
        EXPECT_NEAR((TypeParam::value(a, up) - TypeParam::value(a, down)) / (2 * h), slope, 1e-9);
      }
}

TEST(QuadraticMeansOfP1, AreThoseOfThePolynomialPressureProjection) {
  constexpr QuadraticMeans<P1> means;
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < 4; ++b) {
      EXPECT_NEAR(means.product[a][b], (a == b ? 2.0 : 1.0) / 20, 1e-16);
      EXPECT_NEAR(means.deviation[a][b], (a == b ? 2.0 : 1.0) / 20 - 1.0 / 16, 1e-16);
    }
}

}  // namespace
}  // namespace palpate::kernels_default
