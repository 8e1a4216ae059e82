#pragma once

#include <string>

/// The kernels that OpenBLAS runs in this process. OpenBLAS chooses them while it is loaded, by the
/// model number of the CPU. A release that does not know a newer model takes the kernels of 2004
/// ("Prescott"), and a factorisation then takes 1.4 times as long. The environment variable
/// OPENBLAS_CORETYPE, read at that moment, overrides the choice.
namespace palpate {

/// Restarts the program in the same process, with the same arguments and the BLAS kernels of this
/// CPU's family. Call first thing in main(); returns in the process that continues.
///
/// Sets OPENBLAS_CORETYPE (blasKernelsOf), unless the user set it, and OPENBLAS_NUM_THREADS=1,
/// because each thread of OpenBLAS takes 128 MiB of address space. Kernels of equal speed can
/// differ in their bits (Cooperlake and SkylakeX in single precision), so all machines of a family
/// use the same ones.
void chooseBlasKernels(char** argv);

/// Returns OpenBLAS's name of the kernels: "SkylakeX".
std::string blasKernels();

/// Returns whether a restarted process could use other kernels: this OpenBLAS has several, and the
/// user chose none.
bool blasKernelsMayBeChosen();
/// Makes the program that replaces this one (execve) use these kernels.
void chooseBlasKernelsOfNext(const std::string& kernels);

/// Returns why the kernels are not those of this CPU's family, with the remedy; empty if they are.
std::string whyOtherBlasKernels();

/// Prepares this process for OpenBLAS on any thread: limits it to one thread and lets it allocate
/// its memory, once. Error if the system refuses the memory.
void prepareBlas();

}  // namespace palpate
