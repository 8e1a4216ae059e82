#pragma once

#include <string>
#include <vector>

#include "worker/elements/element_kernels.hpp"

namespace palpate {

/// The fastest element kernels this CPU runs: "avx512", "avx2" or "baseline". The environment
/// variable PALPATE_KERNELS names another one, for reproducing a dataset of an older machine; Error
/// (bad input) when the CPU cannot run it. Results of two families agree to the Newton tolerance,
/// not to the bit, so a dataset records its family.
const ElementKernels& chooseKernels();

/// What the bits of a result depend on: these element kernels and the kernels that OpenBLAS runs
/// (blas_kernels.hpp), for instance "avx512/SkylakeX". The scheduler admits one such word to a
/// build and a dataset records it.
std::string arithmetic(const ElementKernels& kernels);

/// All that this CPU runs, fastest first.
std::vector<const ElementKernels*> supportedKernels();

}  // namespace palpate
