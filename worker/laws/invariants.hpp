#pragma once

#include "worker/laws/strain.hpp"

/// Laws that are sums of functions of one isochoric invariant each, W = sum of f_k(j_k).
///
/// An invariant I(C), homogeneous of degree m, has the isochoric form j = J^(-2m/3) I.
/// With N = dI/dC,
///
///   dj/dC   = J^(-2m/3) (N - m/3 I C^-1)
///   d2j/dC2 = J^(-2m/3) (d2I/dC2 + m/3 I P + m^2/9 I C^-1 (x) C^-1
///                        - m/3 (N (x) C^-1 + C^-1 (x) N))
///
/// where P = -dC^-1/dC, P_IKMN = (C^-1_IM C^-1_KN + C^-1_IN C^-1_KM)/2. Then
///
///   S = 2 sum of f' dj/dC,   D = 4 sum of (f'' dj/dC (x) dj/dC + f' d2j/dC2).
///
/// A law lists its terms once (addTerms), for a StressSum or a TangentSum. See Holzapfel, Nonlinear
/// Solid Mechanics, 2000, sections 6.4 and 6.6.
namespace palpate::PALPATE_KERNEL_NAMESPACE {

/// An isochoric invariant of degree 1 or 2 in C.
template <int degree, class T>
struct Invariant {
  T value;      ///< j
  T scale;      ///< J^(-2 degree/3)
  T normal[6];  ///< scale * dI/dC, tensor components in Voigt order
};

/// The invariants of one strain.
template <class T>
class Invariants {
 public:
  explicit Invariants(const Strain<T>& strain) : e_(strain.e), scale_(inverseTwoThirds(strain.J)) {}

  /// Returns j1 = J^(-2/3) tr C, which is 3 at rest.
  Invariant<1, T> first() const {
    Invariant<1, T> j{scale_ * (3 + 2 * trace()), scale_, {}};
    for (int v = 0; v < 3; ++v) j.normal[v] = scale_;
    return j;
  }

  /// Returns j2 = J^(-4/3) ((tr C)^2 - C:C)/2, which is 3 at rest. dI2/dC = I1 I - C.
  Invariant<2, T> second() const {
    const T squares = e_[0] * e_[0] + e_[1] * e_[1] + e_[2] * e_[2] +
                      0.5 * (e_[3] * e_[3] + e_[4] * e_[4] + e_[5] * e_[5]);
    const T tr = trace(), scale = scale_ * scale_;
    Invariant<2, T> j{scale * (3 + 4 * tr + 2 * (tr * tr - squares)), scale, {}};
    for (int v = 0; v < 3; ++v) j.normal[v] = scale * (2 + 2 * tr - 2 * e_[v]);
    for (int v = 3; v < 6; ++v) j.normal[v] = -scale * e_[v];
    return j;
  }

  /// Returns J^(-2/3) H:C for a structure tensor H, given by its tensor components in Voigt order.
  /// It is tr H at rest.
  Invariant<1, T> along(const T (&H)[6]) const {
    Invariant<1, T> j{H[0] + H[1] + H[2], scale_, {}};
    for (int v = 0; v < 6; ++v) {
      j.value += 2 * H[v] * e_[v];
      j.normal[v] = scale_ * H[v];
    }
    j.value *= scale_;
    return j;
  }

 private:
  T trace() const { return e_[0] + e_[1] + e_[2]; }

  const T (&e_)[6];
  T scale_;  ///< J^(-2/3)
};

/// Adds up the energy W and the stress S of a law, term by term.
template <class T>
class StressSum {
 public:
  /// Adds f(j), given f and its derivatives at j.
  template <int degree>
  void add(const Invariant<degree, T>& j, const T& f, const T& df, const T&) {
    W_ += f;
    for (int v = 0; v < 6; ++v) normal_[v] += 2 * df * j.normal[v];
    along_inverse_ -= 2.0 / 3 * degree * df * j.value;
  }
  /// Adds c (j - 3).
  template <int degree>
  void addLinear(const Invariant<degree, T>& j, double c) {
    add(j, c * (j.value - 3), T{} + c, T{});
  }

  void finish(const T (&C_inverse)[6], T& W, T (&S)[6]) const {
    W = W_;
    for (int v = 0; v < 6; ++v) S[v] = normal_[v] + along_inverse_ * C_inverse[v];
  }

 private:
  T W_{}, normal_[6] = {}, along_inverse_{};
};

/// Adds up the tangent D of a law, term by term.
template <class T>
class TangentSum {
 public:
  explicit TangentSum(const T (&C_inverse)[6]) : Ci_(C_inverse) {}

  template <int degree>
  void add(const Invariant<degree, T>& j, const T&, const T& df, const T& ddf) {
    addCurvatureOfInvariant(j, df);
    T gradient[6];  // dj/dC
    for (int v = 0; v < 6; ++v) gradient[v] = j.normal[v] - degree / 3.0 * j.value * Ci_[v];
    for (int v = 0; v < 6; ++v)
      for (int w = v; w < 6; ++w) dyads_[v][w] += 4 * ddf * gradient[v] * gradient[w];
  }
  template <int degree>
  void addLinear(const Invariant<degree, T>& j, double c) {
    addCurvatureOfInvariant(j, T{} + c);
  }

  void finish(T (&D)[6][6]) const {
    for (int v = 0; v < 6; ++v)
      for (int w = v; w < 6; ++w) {
        const int I = voigt_row[v], K = voigt_column[v], M = voigt_row[w], N = voigt_column[w];
        const T P = 0.5 * (Ci_[voigt_of[I][M]] * Ci_[voigt_of[K][N]] +
                           Ci_[voigt_of[I][N]] * Ci_[voigt_of[K][M]]);
        T sum = dyads_[v][w] + product_ * P + with_inverse_[v] * Ci_[w] + with_inverse_[w] * Ci_[v];
        // d2 I2/dC2 = I (x) I minus the symmetric identity.
        if (w < 3 && v != w) sum += second_;
        if (v >= 3 && v == w) sum -= 0.5 * second_;
        D[v][w] = sum;
        D[w][v] = sum;
      }
  }

 private:
  template <int degree>
  void addCurvatureOfInvariant(const Invariant<degree, T>& j, const T& df) {
    constexpr double m = degree;
    product_ += 4 * m / 3 * df * j.value;
    for (int v = 0; v < 6; ++v)
      with_inverse_[v] += df * (2 * m * m / 9 * j.value * Ci_[v] - 4 * m / 3 * j.normal[v]);
    if constexpr (degree == 2) second_ += 4 * df * j.scale;
  }

  const T (&Ci_)[6];
  T product_{};             ///< factor of P
  T with_inverse_[6] = {};  ///< the tensor A in A (x) C^-1 + C^-1 (x) A
  T second_{};              ///< factor of d2 I2/dC2
  T dyads_[6][6] = {};      ///< upper triangle
};

/// A law made from an energy class. The class defines `template <class T, class Sum> void
/// addTerms(const Strain<T>&, const Invariants<T>&, Sum&) const`. `with_fibers`: addTerms reads
/// Strain::fiber.
template <class Energy, bool with_fibers = false>
struct InvariantLaw : Energy {
  static constexpr bool needs_C_inverse = true, needs_fibers = with_fibers;

  template <class T>
  void evaluate(const Strain<T>& strain, T& W, T (&S)[6]) const {
    StressSum<T> sum;
    this->addTerms(strain, Invariants<T>(strain), sum);
    sum.finish(strain.C_inverse, W, S);
  }
  template <class T>
  void tangent(const Strain<T>& strain, T (&D)[6][6]) const {
    TangentSum<T> sum(strain.C_inverse);
    this->addTerms(strain, Invariants<T>(strain), sum);
    sum.finish(D);
  }
};

}  // namespace palpate::PALPATE_KERNEL_NAMESPACE
