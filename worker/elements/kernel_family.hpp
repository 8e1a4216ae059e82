#pragma once

#include <string>
#include <vector>

#include "worker/elements/element_kernels.hpp"

namespace palpate {

/// Returns the fastest element kernels that this CPU runs: "avx512", "avx2" or "baseline".
///
/// The environment variable PALPATE_KERNELS selects another family, for instance to reproduce a
/// dataset that an older machine computed. Error (bad input) if the CPU cannot run that family.
/// Results of two families agree to the Newton tolerance but not to the bit, so a dataset records
/// its family.
const ElementKernels& chooseKernels();

/// Returns the names of the two kinds of kernels that determine the bits of a result: the element
/// kernels and OpenBLAS's kernels (blas_kernels.hpp), for instance "avx512/SkylakeX". All workers
/// of a build must have the same pair, and a dataset records it.
std::string arithmetic(const ElementKernels& kernels);

/// Returns the other pairs of kernels that this machine can run, fastest first, each written as
/// arithmeticOf() writes it. With kernels of an older CPU family, this machine can join a build of
/// older machines. Empty if the user chose the kernels by an environment variable.
std::vector<std::string> otherArithmetic();
/// Restarts this program in the same process, with the same arguments and with the kernels
/// `arithmetic`. Work in progress is lost. Error if the restart fails, or if `arithmetic` is not in
/// otherArithmetic().
[[noreturn]] void beginAnewWith(const std::string& arithmetic);

/// Returns all kernels that this CPU runs, fastest first.
std::vector<const ElementKernels*> supportedKernels();

}  // namespace palpate
