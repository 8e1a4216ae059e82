#pragma once

#include "worker/laws/invariants.hpp"

namespace palpate::PALPATE_KERNEL_NAMESPACE {

struct YeohEnergy {
  static constexpr bool needs_fibers = false;
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

}  // namespace palpate::PALPATE_KERNEL_NAMESPACE
