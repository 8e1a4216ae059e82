#pragma once

#include "worker/laws/invariants.hpp"

namespace palpate::PALPATE_KERNEL_NAMESPACE {

struct VerondaWestmannEnergy {
  static constexpr bool needs_fibers = false;
  double c1;  ///< Pa; the shear modulus at rest is c1 c2
  double c2;  ///< how fast it stiffens, -

  template <class T, class Sum>
  void addTerms(const Strain<T>&, const Invariants<T>& invariants, Sum& sum) const {
    const Invariant<1, T> j1 = invariants.first();
    const T x = c2 * (j1.value - 3);
    const T slope = c1 * c2 * exponential(x);
    sum.add(j1, c1 * exponentialMinusOne(x), slope, c2 * slope);
    sum.addLinear(invariants.second(), -c1 * c2 / 2);
  }
};

/// W = c1 (exp(c2 (j1 - 3)) - 1) - c1 c2/2 (j2 - 3): skin (Veronda and Westmann 1970). Where exp
/// overflows, W is infinite.
using VerondaWestmann = InvariantLaw<VerondaWestmannEnergy>;

}  // namespace palpate::PALPATE_KERNEL_NAMESPACE
