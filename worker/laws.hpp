#pragma once

/// Strain energies W(gamma), gamma = (F^T F - I)/2 the Green strain (for `Linear`: the small strain), with
/// the second Piola-Kirchhoff stress S = dW/dgamma and the tangent D = dS/dgamma. docs/numerics.md has the
/// derivations.
///
/// T is double, or a pack of doubles in the element kernels, so nothing here may branch on values.
/// Voigt order 11, 22, 33, 12, 23, 13 with engineering shear: strain e = (g11, g22, g33, 2 g12, 2 g23, 2
/// g13), S = (S11, S22, S33, S12, S23, S13), D(i, j) = dS(i)/de(j), 6 x 6 symmetric, both triangles filled.
/// Moduli in Pa.
///
/// Every translation unit that compiles the kernels for another CPU family includes this inside its own
/// namespace.
#ifndef PALPATE_KERNEL_NAMESPACE
#define PALPATE_KERNEL_NAMESPACE kernels_default
#endif

namespace palpate::PALPATE_KERNEL_NAMESPACE {

/// Positions of the six Voigt components in a symmetric 3 x 3 tensor, and back.
constexpr int voigt_row[6] = {0, 1, 2, 0, 1, 0};
constexpr int voigt_column[6] = {0, 1, 2, 1, 2, 2};
constexpr int voigt_of[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

/// What a law is a function of. The laws that are used with det F = 1 also get C^-1 and J, the others find
/// zeros there.
template <class T>
struct Strain {
  T e[6];          ///< Voigt, engineering shear
  T C_inverse[6];  ///< tensor components in Voigt order, C = F^T F
  T J;             ///< det F
};

/// W = lambda/2 (tr g)^2 + mu g:g. Also modified St. Venant-Kirchhoff, where det F = 1 is added.
struct StVenantKirchhoff {
  static constexpr bool small_strain = false;
  double lambda, mu;

  template <class T>
  void evaluate(const Strain<T>& strain, T& W, T (&S)[6]) const {
    const T(&e)[6] = strain.e;
    const T trace = e[0] + e[1] + e[2];
    const T squares =
        e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + 0.5 * (e[3] * e[3] + e[4] * e[4] + e[5] * e[5]);
    W = 0.5 * lambda * trace * trace + mu * squares;
    for (int i = 0; i < 3; ++i) S[i] = lambda * trace + 2 * mu * e[i];
    for (int i = 3; i < 6; ++i) S[i] = mu * e[i];
  }
  template <class T>
  void tangent(const Strain<T>&, T (&D)[6][6]) const {
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

/// x^(-1/3) squared, lane by lane: J^(-2/3) without the branch on the sign of J.
inline double inverseTwoThirds(double J) {
  return 1 / __builtin_cbrt(J * J);
}
template <class T>
T inverseTwoThirds(const T& J) {
  T result;
  for (unsigned l = 0; l < sizeof(T) / sizeof(double); ++l) result[l] = 1 / __builtin_cbrt(J[l] * J[l]);
  return result;
}

/// W = C10 (j1 - 3) + C01 (j2 - 3) with the isochoric invariants j1 = J^(-2/3) I1, j2 = J^(-4/3) I2, to be
/// used with det F = 1.
///
/// Where J = 1 this is the paper's Eq. 7 (less its misprint, a factor 2 on C01). In a discrete solution J is
/// 1 only on average; the isochoric form is the one that GetFEM, the paper's library, computes, and its rest
/// state has no pressure.
struct MooneyRivlin {
  static constexpr bool small_strain = false;
  double c10, c01;

  template <class T>
  void evaluate(const Strain<T>& strain, T& W, T (&S)[6]) const {
    const Invariants<T> v = invariants(strain);
    W = c10 * v.s1 * v.I1 + c01 * v.s2 * v.I2 - 3 * (c10 + c01);
    for (int i = 0; i < 6; ++i)
      S[i] = 2 * c10 * v.s1 * (identity(i) - v.I1 / 3 * strain.C_inverse[i]) +
             2 * c01 * v.s2 * (v.A[i] - 2 * v.I2 / 3 * strain.C_inverse[i]);
  }
  template <class T>
  void tangent(const Strain<T>& strain, T (&D)[6][6]) const {
    const Invariants<T> v = invariants(strain);
    const T(&Ci)[6] = strain.C_inverse;
    const T f1 = 4 * c10 * v.s1, f2 = 4 * c01 * v.s2;
    for (int i = 0; i < 6; ++i)
      for (int j = i; j < 6; ++j) {
        const int I = voigt_row[i], K = voigt_column[i], M = voigt_row[j], N = voigt_column[j];
        const T product =
            0.5 * (Ci[voigt_of[I][M]] * Ci[voigt_of[K][N]] + Ci[voigt_of[I][N]] * Ci[voigt_of[K][M]]);
        const double symmetric_identity = i != j ? 0.0 : i < 3 ? 1.0 : 0.5;
        D[i][j] = f1 * (v.I1 / 3 * product + v.I1 / 9 * Ci[i] * Ci[j] -
                        (identity(i) * Ci[j] + identity(j) * Ci[i]) / 3) +
                  f2 * (identity(i) * identity(j) - symmetric_identity + 2 * v.I2 / 3 * product +
                        4 * v.I2 / 9 * Ci[i] * Ci[j] - 2 * (v.A[i] * Ci[j] + v.A[j] * Ci[i]) / 3);
        D[j][i] = D[i][j];
      }
  }

 private:
  static constexpr double identity(int voigt) { return voigt < 3 ? 1.0 : 0.0; }
  template <class T>
  struct Invariants {
    T I1, I2;
    T s1, s2;  ///< J^(-2/3), J^(-4/3)
    T A[6];    ///< dI2/dC = I1 I - C
  };
  template <class T>
  static Invariants<T> invariants(const Strain<T>& strain) {
    const T(&e)[6] = strain.e;
    Invariants<T> v;
    const T trace = e[0] + e[1] + e[2];
    const T squares =
        e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + 0.5 * (e[3] * e[3] + e[4] * e[4] + e[5] * e[5]);
    v.I1 = 3 + 2 * trace;
    v.I2 = 3 + 4 * trace + 2 * (trace * trace - squares);
    v.s1 = inverseTwoThirds(strain.J);
    v.s2 = v.s1 * v.s1;
    for (int i = 0; i < 3; ++i) v.A[i] = v.I1 - 1 - 2 * e[i];
    for (int i = 3; i < 6; ++i) v.A[i] = -e[i];
    return v;
  }
};

}  // namespace palpate::PALPATE_KERNEL_NAMESPACE
