#pragma once

#include "worker/laws/invariants.hpp"

namespace palpate::PALPATE_KERNEL_NAMESPACE {

struct HolzapfelGasserOgdenEnergy {
  static constexpr bool needs_fibers = true;
  double mu;          ///< shear modulus of the ground matrix, Pa
  double k1;          ///< stiffness of a fibre family, Pa
  double k2;          ///< how fast it stiffens, > 0, -
  double dispersion;  ///< kappa, 0 (all fibres parallel) to 1/3 (isotropic)

  template <class T, class Sum>
  void addTerms(const Strain<T>& strain, const Invariants<T>& invariants, Sum& sum) const {
    sum.addLinear(invariants.first(), mu / 2);
    for (const T(&a)[3] : strain.fiber) {
      // kappa j1 + (1 - 3 kappa) j4 is the invariant along H = kappa I + (1 - 3 kappa) a (x) a.
      // Times a.a, which is 1 or 0: of a zero direction H is zero, and so is E.
      const T length = a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
      T H[6];
      for (int v = 0; v < 6; ++v) {
        H[v] = (1 - 3 * dispersion) * a[voigt_row[v]] * a[voigt_column[v]];
        if (v < 3) H[v] += dispersion * length;
      }
      const Invariant<1, T> j = invariants.along(H);
      const T E = j.value - (H[0] + H[1] + H[2]);
      const auto stretched = E > T{};
      const T x = k2 * E * E;
      const T growth = k1 * exponential(x);
      const T f = k1 / (2 * k2) * exponentialMinusOne(x), df = growth * E,
              ddf = growth * (1 + 2 * x);
      const T zero{};
      sum.add(j, stretched ? f : zero, stretched ? df : zero, stretched ? ddf : zero);
    }
  }
};

/// W = mu/2 (j1 - 3) + k1/(2 k2) sum over the fibre families of (exp(k2 E^2) - 1),
/// E = max(0, kappa (j1 - 3) + (1 - 3 kappa) (j4 - 1)), j4 = J^(-2/3) a.C a, a the direction at
/// rest (Gasser, Ogden and Holzapfel 2006). Fibres bear no compression: D jumps where E = 0, and is
/// the one of E < 0 there. Where exp overflows, W is infinite.
using HolzapfelGasserOgden = InvariantLaw<HolzapfelGasserOgdenEnergy>;

}  // namespace palpate::PALPATE_KERNEL_NAMESPACE
