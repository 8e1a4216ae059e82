#pragma once

/// Quadrature on the tetrahedron. Points in barycentric coordinates, weights with sum 1 (times the
/// volume).
namespace palpate {

template <int n>
struct QuadratureRule {
  static constexpr int points = n;
  double point[n][4];
  double weight[n];
};

/// Exact for linear integrands, and so for whatever is constant in an element.
inline constexpr QuadratureRule<1> centroid_rule = {{{0.25, 0.25, 0.25, 0.25}}, {1.0}};

namespace degree_5 {
inline constexpr double root = 3.8729833462074168852;  // of 15
inline constexpr double a = (7 + root) / 34, a_weight = (2665 - 14 * root) / 37800;
inline constexpr double b = (7 - root) / 34, b_weight = (2665 + 14 * root) / 37800;
inline constexpr double c = (5 - root) / 20, c_weight = 10.0 / 189;
inline constexpr double a_far = 1 - 3 * a, b_far = 1 - 3 * b, c_far = 0.5 - c;
}  // namespace degree_5

/// Exact for polynomials of degree 5: Stroud, Approximate Calculation of Multiple Integrals, 1971,
/// T3:5-1. It is the rule that GetFEM calls IM_TETRAHEDRON(5), with which forces are compared to
/// more digits than the rule's own error.
inline constexpr QuadratureRule<15> degree_5_rule = {
    {{0.25, 0.25, 0.25, 0.25},
     {degree_5::a, degree_5::a, degree_5::a, degree_5::a_far},
     {degree_5::a, degree_5::a, degree_5::a_far, degree_5::a},
     {degree_5::a, degree_5::a_far, degree_5::a, degree_5::a},
     {degree_5::a_far, degree_5::a, degree_5::a, degree_5::a},
     {degree_5::b, degree_5::b, degree_5::b, degree_5::b_far},
     {degree_5::b, degree_5::b, degree_5::b_far, degree_5::b},
     {degree_5::b, degree_5::b_far, degree_5::b, degree_5::b},
     {degree_5::b_far, degree_5::b, degree_5::b, degree_5::b},
     {degree_5::c, degree_5::c, degree_5::c_far, degree_5::c_far},
     {degree_5::c, degree_5::c_far, degree_5::c, degree_5::c_far},
     {degree_5::c_far, degree_5::c, degree_5::c, degree_5::c_far},
     {degree_5::c, degree_5::c_far, degree_5::c_far, degree_5::c},
     {degree_5::c_far, degree_5::c, degree_5::c_far, degree_5::c},
     {degree_5::c_far, degree_5::c_far, degree_5::c, degree_5::c}},
    {16.0 / 135, degree_5::a_weight, degree_5::a_weight, degree_5::a_weight, degree_5::a_weight,
     degree_5::b_weight, degree_5::b_weight, degree_5::b_weight, degree_5::b_weight,
     degree_5::c_weight, degree_5::c_weight, degree_5::c_weight, degree_5::c_weight,
     degree_5::c_weight, degree_5::c_weight}};

}  // namespace palpate
