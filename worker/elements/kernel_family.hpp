#pragma once

#include <string>
#include <vector>

#include "worker/elements/element_kernels.hpp"

namespace palpate {

/// Returns the fastest element kernels that this CPU runs: "avx512", "avx2" or "baseline".
///
/// The environment variable PALPATE_KERNELS selects other ones, to reproduce a dataset of an older
/// machine; Error (bad input) if the CPU cannot run them. Results of two families agree to the
/// Newton tolerance but not to the bit, so a dataset records its family.
const ElementKernels& chooseKernels();

/// Returns the kernels that determine the bits of a result: these element kernels and those of
/// OpenBLAS (blas_kernels.hpp), for instance "avx512/SkylakeX". The scheduler admits one such word
/// to a build, and a dataset records it.
std::string arithmetic(const ElementKernels& kernels);

/// Returns the other values of arithmetic() available on this machine, fastest first, as
/// arithmeticOf() names them: older families, for builds with older machines. Empty if the user
/// chose.
std::vector<std::string> otherArithmetic();
/// Restarts this program in the same process, with the same arguments, to compute with one of
/// otherArithmetic(). Work in progress is lost. Error if the restart fails, or if `arithmetic` is
/// not one of them.
[[noreturn]] void beginAnewWith(const std::string& arithmetic);

/// Returns all kernels that this CPU runs, fastest first.
std::vector<const ElementKernels*> supportedKernels();

}  // namespace palpate
