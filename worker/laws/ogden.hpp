#pragma once

#include "worker/laws/strain.hpp"

namespace palpate::PALPATE_KERNEL_NAMESPACE {

/// Principal values and principal directions of a Green strain, in no particular order.
template <class T>
struct PrincipalStrains {
  T value[3];
  T direction[3][3];  ///< direction[i]: unit vector of value[i]
};

/// Computes principal strains by cyclic Jacobi rotations. The directions are orthogonal to
/// round-off, even if some values coincide.
///
/// The number of sweeps is fixed. In three million random tensors, some with nearly equal or widely
/// different values, the off-diagonal entries were below 1e-17 of the largest entry after four
/// sweeps. The fifth sweep is a margin.
template <class T>
PrincipalStrains<T> principalStrains(const T (&e)[6]) {
  constexpr int sweeps = 5;
  constexpr int pairs[3][3] = {{0, 1, 2}, {0, 2, 1}, {1, 2, 0}};
  T g[3][3];
  PrincipalStrains<T> principal{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) g[i][j] = i == j ? e[i] : 0.5 * e[voigt_of[i][j]];
    principal.direction[i][i] += 1.0;
  }
  for (int rotation = 0; rotation < 3 * sweeps; ++rotation) {
    const auto [p, q, r] = pairs[rotation % 3];
    // t is the tangent of the smaller of the two angles of rotation that make g[p][q] zero.
    const T difference = g[q][q] - g[p][p], twice = 2 * g[p][q];
    const T root = squareRoot(difference * difference + twice * twice);
    const T denominator = difference < T{} ? difference - root : difference + root;
    const T t = denominator == T{} ? T{} : twice / denominator;
    const T cosine = 1 / squareRoot(1 + t * t), sine = t * cosine;
    g[p][p] -= t * g[p][q];
    g[q][q] += t * g[p][q];
    g[p][q] = g[q][p] = T{};
    const T g_pr = cosine * g[p][r] - sine * g[q][r], g_qr = sine * g[p][r] + cosine * g[q][r];
    g[p][r] = g[r][p] = g_pr;
    g[q][r] = g[r][q] = g_qr;
    for (int I = 0; I < 3; ++I) {
      const T n_p = principal.direction[p][I], n_q = principal.direction[q][I];
      principal.direction[p][I] = cosine * n_p - sine * n_q;
      principal.direction[q][I] = sine * n_p + cosine * n_q;
    }
  }
  for (int i = 0; i < 3; ++i) principal.value[i] = g[i][i];
  return principal;
}

/// W = sum over terms of mu/alpha (l1^alpha + l2^alpha + l3^alpha - 3), with the isochoric
/// principal stretches l_i = J^(-1/3) lambda_i (Ogden 1972). The shear modulus at rest is the sum
/// of mu alpha/2.
///
/// Computed in principal directions as in Simo and Taylor 1991. Let c_i, n_i be the eigenvalues and
/// eigenvectors of C, y_i = ln l_i and b_i = sum of mu l_i^alpha.
/// With the Kirchhoff stresses tau_i = b_i - mean of b,
///
///   S = sum of tau_i/c_i n_i (x) n_i
///   D = sum over i, j of d_ij n_i (x) n_i (x) n_j (x) n_j
///     + sum over i < j of h_ij N_ij (x) N_ij,   N_ij = n_i (x) n_j + n_j (x) n_i
///   d_ij = dtau_i/dy_j / (c_i c_j) - [i = j] 2 tau_i/c_i^2
///   h_ij = (tau_i/c_i - tau_j/c_j)/(c_i - c_j)
///        = ((b_i - b_j)/(c_i - c_j) (c_i + c_j) - tau_i - tau_j)/(2 c_i c_j)
///
/// and, with d = y_i - y_j and without cancellation for nearly equal stretches,
///
///   (b_i - b_j)/(c_i - c_j)
///        = sum of mu (l_i l_j)^(alpha/2) / sqrt(c_i c_j) sinh(alpha d/2)/sinh(d).
struct Ogden {
  static constexpr bool needs_C_inverse = false;  // J follows from the eigenvalues
  static constexpr bool needs_fibers = false;
  double mu[3];     ///< Pa
  double alpha[3];  ///< -, not 0
  int terms;        ///< number of terms, 1 to 3

  template <class T>
  void evaluate(const Strain<T>& strain, T& W, T (&S)[6]) const {
    const Principal<T> p = principal(strain);
    W = p.W;
    for (int v = 0; v < 6; ++v) {
      S[v] = T{};
      for (int i = 0; i < 3; ++i)
        S[v] += p.tau[i] / p.c[i] * p.n[i][voigt_row[v]] * p.n[i][voigt_column[v]];
    }
  }

  template <class T>
  void tangent(const Strain<T>& strain, T (&D)[6][6]) const {
    const Principal<T> p = principal(strain);
    T normal[3][3], n_n[3][6], shear[3], N[3][6];
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      normal[i][i] = (slope(p, i, i) - 2 * p.tau[i]) / (p.c[i] * p.c[i]);
      normal[i][j] = normal[j][i] = slope(p, i, j) / (p.c[i] * p.c[j]);
      shear[i] = shearCoefficient(p, i, j);
      for (int v = 0; v < 6; ++v) {
        const int I = voigt_row[v], K = voigt_column[v];
        n_n[i][v] = p.n[i][I] * p.n[i][K];
        N[i][v] = p.n[i][I] * p.n[j][K] + p.n[j][I] * p.n[i][K];
      }
    }
    for (int w = 0; w < 6; ++w) {
      T column[3];
      for (int i = 0; i < 3; ++i)
        column[i] = normal[i][0] * n_n[0][w] + normal[i][1] * n_n[1][w] + normal[i][2] * n_n[2][w];
      for (int v = 0; v <= w; ++v) {
        D[v][w] = T{};
        for (int i = 0; i < 3; ++i) D[v][w] += n_n[i][v] * column[i] + shear[i] * N[i][v] * N[i][w];
        D[w][v] = D[v][w];
      }
    }
  }

 private:
  template <class T>
  struct Principal {
    T c[3], n[3][3], y[3];
    T W, tau[3];
    T db[3];  ///< db_i/dy_i = sum of mu alpha l_i^alpha
  };

  template <class T>
  Principal<T> principal(const Strain<T>& strain) const {
    const PrincipalStrains<T> strains = principalStrains(strain.e);
    Principal<T> p{};
    for (int i = 0; i < 3; ++i) {
      p.c[i] = 1 + 2 * strains.value[i];
      p.y[i] = 0.5 * logarithmOfOnePlus(2 * strains.value[i]);
      for (int I = 0; I < 3; ++I) p.n[i][I] = strains.direction[i][I];
    }
    const T mean_y = (p.y[0] + p.y[1] + p.y[2]) / 3;
    for (T& y : p.y) y -= mean_y;
    for (int i = 0; i < 3; ++i)
      for (int term = 0; term < terms; ++term) {
        const T power = exponentialMinusOne(alpha[term] * p.y[i]);  // l_i^alpha - 1
        p.W += mu[term] / alpha[term] * power;
        p.tau[i] += mu[term] * power;
        p.db[i] += mu[term] * alpha[term] * (1 + power);
      }
    const T mean_tau = (p.tau[0] + p.tau[1] + p.tau[2]) / 3;
    for (T& tau : p.tau) tau -= mean_tau;
    return p;
  }

  /// Returns the derivative of tau_i with respect to ln lambda_j, written dtau_i/dy_j above. (The
  /// y_j are not independent, because their sum is zero.) Its sums over i and over j are zero.
  template <class T>
  static T slope(const Principal<T>& p, int i, int j) {
    const T deviatoric = (p.db[0] + p.db[1] + p.db[2]) / 9 - (p.db[i] + p.db[j]) / 3;
    return i == j ? deviatoric + p.db[i] : deviatoric;
  }

  /// Returns h_ij of the formulas above.
  template <class T>
  T shearCoefficient(const Principal<T>& p, int i, int j) const {
    const T d = p.y[i] - p.y[j], sinh_d = hyperbolicSine(d);
    T quotient{};
    for (int term = 0; term < terms; ++term) {
      const T equal = T{} + alpha[term] / 2;
      const T ratio = sinh_d == T{} ? equal : hyperbolicSine(alpha[term] / 2 * d) / sinh_d;
      quotient += mu[term] * exponential(alpha[term] / 2 * (p.y[i] + p.y[j])) * ratio;
    }
    const T product = p.c[i] * p.c[j];
    return (quotient / squareRoot(product) * (p.c[i] + p.c[j]) - p.tau[i] - p.tau[j]) /
           (2 * product);
  }
};

}  // namespace palpate::PALPATE_KERNEL_NAMESPACE
