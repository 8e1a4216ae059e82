#pragma once

#include "worker/laws/strain.hpp"

namespace palpate::PALPATE_KERNEL_NAMESPACE {

template <class T>
struct VolumeDerivatives {
  T U, dU, ddU;  ///< with respect to J
};

/// U(J) = bulk/4 (J^2 - 1 - 2 ln J), what a compressible material adds to its isochoric energy
/// (Simo and Miehe 1992). bulk: Pa, U''(1). A barrier: infinite at J = 0; NaN where J < 0.
template <class T>
VolumeDerivatives<T> volumetricEnergy(double bulk, const T& J) {
  const T x = J - 1, inverse = 1 / J;  // in x: no cancellation near J = 1
  return {bulk / 4 * (x * x + 2 * (x - logarithmOfOnePlus(x))), bulk / 2 * x * (J + 1) * inverse,
          bulk / 2 * (1 + inverse * inverse)};
}

}  // namespace palpate::PALPATE_KERNEL_NAMESPACE
