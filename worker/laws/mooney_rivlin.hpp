#pragma once

#include "worker/laws/invariants.hpp"

namespace palpate::PALPATE_KERNEL_NAMESPACE {

struct MooneyRivlinEnergy {
  static constexpr bool needs_fibers = false;
  double c10, c01;  ///< Pa; the shear modulus at rest is 2 (c10 + c01)

  template <class T, class Sum>
  void addTerms(const Strain<T>&, const Invariants<T>& invariants, Sum& sum) const {
    sum.addLinear(invariants.first(), c10);
    sum.addLinear(invariants.second(), c01);
  }
};

/// W = c10 (j1 - 3) + c01 (j2 - 3) (Mooney 1940, Rivlin 1948).
///
/// Where J = 1 this is the paper's Eq. 7 (less its misprint, a factor 2 on c01). In a discrete
/// solution J is 1 only on average; the isochoric form is the one that GetFEM, the paper's library,
/// computes, and its rest state has no pressure.
using MooneyRivlin = InvariantLaw<MooneyRivlinEnergy>;

}  // namespace palpate::PALPATE_KERNEL_NAMESPACE
