#pragma once

#include "worker/laws/invariants.hpp"

/// Laws that are sums of functions of invariants, and the volumetric energy that complements an
/// isochoric law.
namespace palpate::PALPATE_KERNEL_NAMESPACE {

struct NeoHookeanEnergy {
  double mu;  ///< shear modulus, Pa

  template <class T, class Sum>
  void addTerms(const Strain<T>&, const Invariants<T>& invariants, Sum& sum) const {
    sum.addLinear(invariants.first(), mu / 2);
  }
};

/// W = mu/2 (j1 - 3): a network of Gaussian chains (Treloar 1943).
using NeoHookean = InvariantLaw<NeoHookeanEnergy>;

struct MooneyRivlinEnergy {
  double c10, c01;  ///< Pa; the shear modulus at rest is 2 (c10 + c01)

  template <class T, class Sum>
  void addTerms(const Strain<T>&, const Invariants<T>& invariants, Sum& sum) const {
    sum.addLinear(invariants.first(), c10);
    sum.addLinear(invariants.second(), c01);
  }
};

/// W = c10 (j1 - 3) + c01 (j2 - 3) (Mooney 1940, Rivlin 1948).
///
/// For J = 1 this is Eq. 7 of Peterlik et al. (2010), without its misprint, a factor 2 on c01. In a
/// discrete solution J is 1 only on average. GetFEM, the library used in that paper, computes this
/// isochoric form. The rest state of this form has no pressure.
using MooneyRivlin = InvariantLaw<MooneyRivlinEnergy>;

struct YeohEnergy {
  double c10, c20, c30;  ///< Pa; the shear modulus at rest is 2 c10

  template <class T, class Sum>
  void addTerms(const Strain<T>&, const Invariants<T>& invariants, Sum& sum) const {
    const Invariant<1, T> j1 = invariants.first();
    const T x = j1.value - 3;
    sum.add(j1, x * (c10 + x * (c20 + x * c30)), c10 + x * (2 * c20 + x * 3 * c30),
            2 * c20 + x * 6 * c30);
  }
};

/// W = c10 (j1 - 3) + c20 (j1 - 3)^2 + c30 (j1 - 3)^3 (Yeoh 1993).
using Yeoh = InvariantLaw<YeohEnergy>;

struct VerondaWestmannEnergy {
  double c1;  ///< Pa; the shear modulus at rest is c1 c2
  double c2;  ///< rate of stiffening, -

  template <class T, class Sum>
  void addTerms(const Strain<T>&, const Invariants<T>& invariants, Sum& sum) const {
    const Invariant<1, T> j1 = invariants.first();
    const T x = c2 * (j1.value - 3);
    const T slope = c1 * c2 * exponential(x);
    sum.add(j1, c1 * exponentialMinusOne(x), slope, c2 * slope);
    sum.addLinear(invariants.second(), -c1 * c2 / 2);
  }
};

/// W = c1 (exp(c2 (j1 - 3)) - 1) - c1 c2/2 (j2 - 3), for skin (Veronda and Westmann 1970). Infinite
/// if exp overflows.
using VerondaWestmann = InvariantLaw<VerondaWestmannEnergy>;

struct HolzapfelGasserOgdenEnergy {
  double mu;          ///< shear modulus of the ground matrix, Pa
  double k1;          ///< stiffness of a fibre family, Pa
  double k2;          ///< rate at which a fibre family stiffens, > 0, -
  double dispersion;  ///< kappa, 0 (all fibres parallel) to 1/3 (isotropic)

  static constexpr double round_off = 1e-12;  ///< error of E, which is not exactly zero at rest

  template <class T, class Sum>
  void addTerms(const Strain<T>& strain, const Invariants<T>& invariants, Sum& sum) const {
    sum.addLinear(invariants.first(), mu / 2);
    for (const T(&a)[3] : strain.fiber) {
      // kappa j1 + (1 - 3 kappa) j4 is the invariant along H = kappa I + (1 - 3 kappa) a (x) a.
      // Here kappa I is multiplied by a.a, which is 1, or 0 for an absent fibre family. An absent
      // family thus has H = 0 and E = 0.
      const T length = a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
      T H[6];
      for (int v = 0; v < 6; ++v) {
        H[v] = (1 - 3 * dispersion) * a[voigt_row[v]] * a[voigt_column[v]];
        if (v < 3) H[v] += dispersion * length;
      }
      const Invariant<1, T> j = invariants.along(H);
      const T E = j.value - (H[0] + H[1] + H[2]);
      const auto stretched = E > T{}, neither = E * E < round_off * round_off;
      const T x = k2 * E * E;
      const T growth = k1 * exponential(x);
      const T f = k1 / (2 * k2) * exponentialMinusOne(x), df = growth * E,
              ddf = growth * (1 + 2 * x);
      const T zero{}, mean = zero + k1 / 2;
      sum.add(j, stretched ? f : zero, stretched ? df : zero,
              neither ? mean : (stretched ? ddf : zero));
    }
  }
};

/// Fibre-reinforced tissue (Gasser, Ogden and Holzapfel 2006). The energy is
///
///   W = mu/2 (j1 - 3) + k1/(2 k2) sum over the fibre families of (exp(k2 E^2) - 1)
///   E = max(0, kappa (j1 - 3) + (1 - 3 kappa) (j4 - 1)),   j4 = J^(-2/3) a.C a
///
/// with a the fibre direction at rest. Fibres bear no compression, so the tangent D jumps at E = 0.
/// In the rest state all fibres are at E = 0, where D is the mean of its values on both sides. W is
/// infinite if exp overflows.
using HolzapfelGasserOgden = InvariantLaw<HolzapfelGasserOgdenEnergy, true>;

template <class T>
struct VolumeDerivatives {
  T U, dU, ddU;  ///< U, dU/dJ, d2U/dJ2
};

/// U(J) = bulk/4 (J^2 - 1 - 2 ln J), the volumetric energy of a compressible material (Simo and
/// Miehe 1992). `bulk` is U''(1), Pa. U is infinite at J = 0 and NaN for J < 0.
template <class T>
VolumeDerivatives<T> volumetricEnergy(double bulk, const T& J) {
  const T x = J - 1, inverse = 1 / J;  // written in x to avoid cancellation near J = 1
  return {bulk / 4 * (x * x + 2 * (x - logarithmOfOnePlus(x))), bulk / 2 * x * (J + 1) * inverse,
          bulk / 2 * (1 + inverse * inverse)};
}

}  // namespace palpate::PALPATE_KERNEL_NAMESPACE
