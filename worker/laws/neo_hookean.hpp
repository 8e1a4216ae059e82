#pragma once

#include "worker/laws/invariants.hpp"

namespace palpate::PALPATE_KERNEL_NAMESPACE {

struct NeoHookeanEnergy {
  static constexpr bool needs_fibers = false;
  double mu;  ///< shear modulus, Pa

  template <class T, class Sum>
  void addTerms(const Strain<T>&, const Invariants<T>& invariants, Sum& sum) const {
    sum.addLinear(invariants.first(), mu / 2);
  }
};

/// W = mu/2 (j1 - 3): a network of Gaussian chains (Treloar 1943).
using NeoHookean = InvariantLaw<NeoHookeanEnergy>;

}  // namespace palpate::PALPATE_KERNEL_NAMESPACE
