#pragma once

/// Quadrature rules and function spaces on a straight-sided tetrahedron, as polynomials of its
/// barycentric coordinates x.
///
/// Each node has one end (P1) or two ends (P2). Ends are vertices, and the node is the midpoint of
/// its ends. Its shape function N_a depends only on the coordinates of its ends, so
///
///   grad N_a = sum over its ends e of  slope(a, e, x) grad x_end(a, e)
///
/// with the same grad x everywhere in the element.
///
/// Every translation unit that compiles kernels gets its own copy, in its own namespace.
#ifndef PALPATE_KERNEL_NAMESPACE
#define PALPATE_KERNEL_NAMESPACE kernels_default
#endif

namespace palpate::PALPATE_KERNEL_NAMESPACE {

/// Points in barycentric coordinates, and weights that add up to 1 (multiply by the volume).
template <int n>
struct QuadratureRule {
  static constexpr int points = n;
  double point[n][4];
  double weight[n];
};

/// Exact for linear integrands.
inline constexpr QuadratureRule<1> centroid_rule = {{{0.25, 0.25, 0.25, 0.25}}, {1.0}};

/// Exact for polynomials of degree 5: Stroud, Approximate Calculation of Multiple Integrals, 1971,
/// T3:5-1. GetFEM calls this rule IM_TETRAHEDRON(5). Because both programs use it, their forces can
/// be compared to more digits than the error of the rule.
inline constexpr QuadratureRule<15> degree_5_rule = [] {
  const double root = 3.8729833462074168852;  // of 15
  const double a = (7 + root) / 34, a_far = 1 - 3 * a, a_weight = (2665 - 14 * root) / 37800;
  const double b = (7 - root) / 34, b_far = 1 - 3 * b, b_weight = (2665 + 14 * root) / 37800;
  const double c = (5 - root) / 20, c_far = 0.5 - c, c_weight = 10.0 / 189;
  return QuadratureRule<15>{
      {{0.25, 0.25, 0.25, 0.25},
       {a, a, a, a_far},
       {a, a, a_far, a},
       {a, a_far, a, a},
       {a_far, a, a, a},
       {b, b, b, b_far},
       {b, b, b_far, b},
       {b, b_far, b, b},
       {b_far, b, b, b},
       {c, c, c_far, c_far},
       {c, c_far, c, c_far},
       {c_far, c, c, c_far},
       {c, c_far, c_far, c},
       {c_far, c, c_far, c},
       {c_far, c_far, c, c}},
      {16.0 / 135, a_weight, a_weight, a_weight, a_weight, b_weight, b_weight, b_weight, b_weight,
       c_weight, c_weight, c_weight, c_weight, c_weight, c_weight}};
}();

/// N_a = x_a.
struct P1 {
  static constexpr int nodes = 4, ends = 1;
  static constexpr int end[nodes][ends] = {{0}, {1}, {2}, {3}};
  static constexpr double value(int a, const double (&x)[4]) { return x[a]; }
  static constexpr double slope(int, int, const double (&)[4]) { return 1; }

  /// F is constant in the element, so one quadrature point is exact.
  static constexpr const auto& rule = centroid_rule;
};

/// N_a = x_a (2 x_a - 1) at the vertices, 4 x_i x_j at the midpoint of edge ij. Edges are in the
/// order of tetrahedron_edges (common/mesh/mesh.hpp).
struct P2 {
  static constexpr int nodes = 10, ends = 2;
  static constexpr int end[nodes][ends] = {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {0, 1},
                                           {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  static constexpr double value(int a, const double (&x)[4]) {
    return a < 4 ? x[a] * (2 * x[a] - 1) : 4 * x[end[a][0]] * x[end[a][1]];
  }
  /// A vertex node has the same vertex as both of its ends. Each end contributes half of the slope
  /// 4 x_a - 1.
  static constexpr double slope(int a, int e, const double (&x)[4]) {
    return a < 4 ? 2 * x[a] - 0.5 : 4 * x[end[a][1 - e]];
  }

  static constexpr const auto& rule = degree_5_rule;
};

/// The space of an absent field: it has no nodes.
struct NoSpace {
  static constexpr int nodes = 0;
  static constexpr double value(int, const double (&)[4]) { return 0; }
};

/// Mean values over the element of N_a N_b (`product`), and of N_a N_b minus mean N_a * mean N_b
/// (`deviation`). They are the matrices of two quadratic forms of a field f: the mean of f^2, and
/// the mean of (f - mean f)^2.
template <class Space>
struct QuadraticMeans {
  double product[Space::nodes][Space::nodes] = {};
  double deviation[Space::nodes][Space::nodes] = {};

  constexpr QuadraticMeans() {
    double mean[Space::nodes] = {};
    for (int n = 0; n < degree_5_rule.points; ++n)
      for (int a = 0; a < Space::nodes; ++a) {
        const double(&x)[4] = degree_5_rule.point[n];
        mean[a] += degree_5_rule.weight[n] * Space::value(a, x);
        for (int b = 0; b < Space::nodes; ++b)
          product[a][b] += degree_5_rule.weight[n] * Space::value(a, x) * Space::value(b, x);
      }
    for (int a = 0; a < Space::nodes; ++a)
      for (int b = 0; b < Space::nodes; ++b) deviation[a][b] = product[a][b] - mean[a] * mean[b];
  }
};

}  // namespace palpate::PALPATE_KERNEL_NAMESPACE
