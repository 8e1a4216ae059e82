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

/// What else arithmetic() could say on this machine, fastest first, in the words of arithmeticOf():
/// older families, for builds in which older machines work too. None when the user chose.
std::vector<std::string> otherArithmetic();
/// Starts this program anew, in the same process and with the same arguments, to compute with one
/// of those; what it was doing is lost. Error when that cannot be done, and when they are none of
/// those.
[[noreturn]] void beginAnewWith(const std::string& arithmetic);

/// All that this CPU runs, fastest first.
std::vector<const ElementKernels*> supportedKernels();

}  // namespace palpate
