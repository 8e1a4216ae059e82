#pragma once

#include <string>

/// Which of its kernels OpenBLAS runs in this process. It chooses them while it is loaded, by the
/// model number of the CPU; a release that does not know a newer model takes those of 2004
/// ("Prescott"), and a factorisation then takes 1.4 times as long. The environment variable
/// OPENBLAS_CORETYPE, read at that moment, overrules it.
namespace palpate {

/// Call first thing in main(). Starts the program anew, in the same process and with the same
/// arguments: with OPENBLAS_NUM_THREADS=1 when it was loaded without, because each of its threads
/// takes 128 MiB of address space; and, when OpenBLAS chose other kernels than those of this CPU's
/// family (blasKernelsOf), or kernels that compute wrong products here, with OPENBLAS_CORETYPE set
/// to the fastest that are right. Returns in the process that is to go on. A core type that the
/// user set stays.
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

/// Why they are slower than this CPU allows, and what to do; empty when they are not.
std::string whyBlasIsSlow();

/// For what is to compute with OpenBLAS in this process, on any thread: holds it to one thread.
/// Error when the system refuses the memory that it needs, or its products are wrong; both are
/// checked once. Ends the process (exit 1) when OpenBLAS computes no product within a minute.
void prepareBlas();

}  // namespace palpate
