#pragma once

#include <string>

/// Which of its kernels OpenBLAS runs in this process. It chooses them while it is loaded, by the
/// model number of the CPU; a release that does not know a newer model takes those of 2004
/// ("Prescott"), and a factorisation then takes 1.4 times as long. The environment variable
/// OPENBLAS_CORETYPE, read at that moment, overrules it.
namespace palpate {

/// Call first thing in main(). Starts the program once more, in the same process and with the same
/// arguments, with OPENBLAS_CORETYPE set to the kernels of this CPU's family (blasKernelsOf), and
/// with OPENBLAS_NUM_THREADS=1, because each thread of OpenBLAS takes 128 MiB of address space.
/// Returns in the process that is to go on. A core type that the user set stays.
///
/// Kernels that are as fast have other bits (Cooperlake and SkylakeX in single precision), so all
/// machines of a family take the same ones.
void chooseBlasKernels(char** argv);

/// What OpenBLAS calls them: "SkylakeX".
std::string blasKernels();

/// Whether others could be had in a process that is started anew: OpenBLAS has several, and the
/// user chose none.
bool blasKernelsMayBeChosen();
/// For the program that takes the place of this one (execve): it computes with these.
void chooseBlasKernelsOfNext(const std::string& kernels);

/// Why they are not those of this CPU's family, and what to do; empty when they are.
std::string whyOtherBlasKernels();

/// For what is to compute with OpenBLAS in this process, on any thread: holds it to one thread and
/// lets it take its memory, once. Error when the system refuses it.
void prepareBlas();

}  // namespace palpate
