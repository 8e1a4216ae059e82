#pragma once

/// Definitions shared by the laws.
///
/// T is double, or in the element kernels a pack of doubles (lane l belongs to element l of a
/// batch). The lanes of a pack cannot take different branches, so no code in this folder branches
/// on values. `condition ? a : b` selects lane by lane, and functions of the C library are called
/// lane by lane.
///
/// Voigt order 11, 22, 33, 12, 23, 13 with engineering shear:
///
///   e = (g11, g22, g33, 2 g12, 2 g23, 2 g13)       strain
///   S = (S11, S22, S33, S12, S23, S13)             stress
///   D(i, j) = dS(i)/de(j)                          6 x 6 symmetric, both triangles filled
///
/// Every translation unit that compiles kernels gets its own copy, in its own namespace.
#ifndef PALPATE_KERNEL_NAMESPACE
#define PALPATE_KERNEL_NAMESPACE kernels_default
#endif

namespace palpate::PALPATE_KERNEL_NAMESPACE {

/// Positions of the six Voigt components in a symmetric 3 x 3 tensor, and back.
constexpr int voigt_row[6] = {0, 1, 2, 0, 1, 0};
constexpr int voigt_column[6] = {0, 1, 2, 1, 2, 2};
constexpr int voigt_of[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

/// The strain at which a law is evaluated.
template <class T>
struct Strain {
  T e[6];  ///< strain in Voigt order, engineering shear
  /// Inverse of C = F^T F, tensor components in Voigt order. Set only if Law::needs_C_inverse.
  T C_inverse[6];
  T J;  ///< det F; set only if Law::needs_C_inverse
  /// Unit directions of the fibre families at rest, zero if absent. Set only if Law::needs_fibers.
  T fiber[2][3];
};

/// Returns f of every lane.
template <class Function>
double lanewise(double x, Function f) {
  return f(x);
}
template <class T, class Function>
T lanewise(const T& x, Function f) {
  T y;
  for (unsigned l = 0; l < sizeof(T) / sizeof(double); ++l) y[l] = f(x[l]);
  return y;
}

inline auto exponential(const auto& x) {
  return lanewise(x, [](double lane) { return __builtin_exp(lane); });
}
/// Returns exp(x) - 1, accurate for small x.
inline auto exponentialMinusOne(const auto& x) {
  return lanewise(x, [](double lane) { return __builtin_expm1(lane); });
}
/// Returns ln(1 + x), accurate for small x; NaN for x < -1.
inline auto logarithmOfOnePlus(const auto& x) {
  return lanewise(x, [](double lane) { return __builtin_log1p(lane); });
}
inline auto squareRoot(const auto& x) {
  return lanewise(x, [](double lane) { return __builtin_sqrt(lane); });
}
inline auto hyperbolicSine(const auto& x) {
  return lanewise(x, [](double lane) { return __builtin_sinh(lane); });
}
/// Returns J^(-2/3), also for negative J.
inline double inverseTwoThirds(double J) { return 1 / __builtin_cbrt(J * J); }
/// Returns J^(-2/3) for all lanes of a pack at once, accurate to two units in the last place. Calls
/// of the C library, one per lane, would take a tenth of the time of an assembly.
///
/// Let x = J^2 and y = x^(-1/3). Read as integers, the bits of y are about a constant minus a third
/// of the bits of x. The error of this first guess is 0.035, and each correction cubes the error. A
/// correction uses the series of (1 - r)^(-1/3) with r = 1 - x y^3.
template <class T>
T inverseTwoThirds(const T& J) {
  using Bits = decltype(J < T{});
  constexpr long constant = 0x553ef0ff289dd796;
  const T x = J * J;
  Bits third = __builtin_bit_cast(Bits, x);
  third = (third >> 2) + (third >> 4);  // 1/3 = (1/4 + 1/16) (1 + 1/16) (1 + 1/256) ...
  third += third >> 4;
  third += third >> 8;
  third += third >> 16;
  T y = __builtin_bit_cast(T, constant - third);
  for (int correction = 0; correction < 3; ++correction) {
    const T r = 1 - x * y * y * y;
    y += y * r * (1.0 / 3 + r * (2.0 / 9));
  }
  return y;
}

}  // namespace palpate::PALPATE_KERNEL_NAMESPACE
