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

/// What the bits of a result depend on: the element kernels and the kernels that OpenBLAS chose for
/// this CPU, for instance "avx512/SkylakeX". The environment variable OPENBLAS_CORETYPE chooses the
/// latter.
std::string arithmetic(const ElementKernels& kernels);

/// All that this CPU runs, fastest first.
std::vector<const ElementKernels*> supportedKernels();

}  // namespace palpate
