#pragma once

#include "worker/laws/strain.hpp"

namespace palpate::PALPATE_KERNEL_NAMESPACE {

/// W = lambda/2 (tr g)^2 + mu g:g, with g the Green strain. Modified St. Venant-Kirchhoff uses it
/// with the constraint det F = 1, and linear elasticity uses it with the small strain as g.
struct StVenantKirchhoff {
  static constexpr bool needs_C_inverse = false, needs_fibers = false;
  double lambda, mu;  ///< Lame's constants, Pa

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

}  // namespace palpate::PALPATE_KERNEL_NAMESPACE
