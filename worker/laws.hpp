#pragma once

/// Strain energies W(gamma), gamma = (F^T F - I)/2 the Green strain (for `Linear`: the small strain), with the second
/// Piola-Kirchhoff stress S = dW/dgamma and the tangent D = dS/dgamma. DESIGN: docs/numerics.md.
///
/// T is double, or a pack of doubles in the element kernels, so nothing here may branch on values.
/// Voigt order 11, 22, 33, 12, 23, 13 with engineering shear: strain e = (g11, g22, g33, 2 g12, 2 g23, 2 g13),
/// S = (S11, S22, S33, S12, S23, S13), D(i, j) = dS(i)/de(j), 6 x 6 symmetric, both triangles filled. Moduli in Pa.
///
/// Every translation unit that compiles the kernels for another CPU family includes this inside its own namespace.
#ifndef PALPATE_KERNEL_NAMESPACE
#define PALPATE_KERNEL_NAMESPACE kernels_default
#endif

namespace palpate::PALPATE_KERNEL_NAMESPACE {

/// W = lambda/2 (tr e)^2 + mu e:e of the Green strain. Also modified St. Venant-Kirchhoff, where det F = 1 is added.
struct StVenantKirchhoff {
  static constexpr bool small_strain = false;
  double lambda, mu;

  template <class T>
  void evaluate(const T (&e)[6], T& W, T (&S)[6]) const {
    const T trace = e[0] + e[1] + e[2];
    const T squares = e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + 0.5 * (e[3] * e[3] + e[4] * e[4] + e[5] * e[5]);
    W = 0.5 * lambda * trace * trace + mu * squares;
    for (int i = 0; i < 3; ++i) S[i] = lambda * trace + 2 * mu * e[i];
    for (int i = 3; i < 6; ++i) S[i] = mu * e[i];
  }
  template <class T>
  void tangent(const T (&)[6], T (&D)[6][6]) const {
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) {
        const double normal = i < 3 && j < 3 ? lambda : 0.0;
        D[i][j] = T{} + (normal + (i != j ? 0.0 : i < 3 ? 2 * mu : mu));
      }
  }
};

/// The same energy of the small strain: linear elasticity, for comparison.
struct Linear : StVenantKirchhoff {
  static constexpr bool small_strain = true;
};

/// W = C10 (I1 - 3) + C01 (I2 - 3) = 2 [(C10 + 2 C01) tr g + C01 ((tr g)^2 - g:g)], to be used with det F = 1.
/// (Eq. 7 of the paper prints 2 C01 inside the bracket; that is a misprint.)
struct MooneyRivlin {
  static constexpr bool small_strain = false;
  double c10, c01;

  template <class T>
  void evaluate(const T (&e)[6], T& W, T (&S)[6]) const {
    const T trace = e[0] + e[1] + e[2];
    const T squares = e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + 0.5 * (e[3] * e[3] + e[4] * e[4] + e[5] * e[5]);
    const double a = c10 + 2 * c01;
    W = 2 * (a * trace + c01 * (trace * trace - squares));
    for (int i = 0; i < 3; ++i) S[i] = 2 * (a + 2 * c01 * (trace - e[i]));
    for (int i = 3; i < 6; ++i) S[i] = -2 * c01 * e[i];
  }
  template <class T>
  void tangent(const T (&)[6], T (&D)[6][6]) const {
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) {
        const double value = i < 3 && j < 3 ? (i == j ? 0.0 : 4 * c01) : i == j ? -2 * c01 : 0.0;
        D[i][j] = T{} + value;
      }
  }
};

}  // namespace palpate::PALPATE_KERNEL_NAMESPACE
