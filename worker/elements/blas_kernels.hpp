#pragma once

#include <string>

/// The BLAS kernels that OpenBLAS runs in this process. While OpenBLAS is loaded, it chooses them
/// by the model number of the CPU. An old release does not know new models and falls back to
/// kernels from 2004 ("Prescott"); a factorisation then takes 1.4 times as long. The environment
/// variable OPENBLAS_CORETYPE overrides the choice. OpenBLAS reads it only while it is loaded.
namespace palpate {

/// Makes this program run on one OpenBLAS thread with the BLAS kernels of this CPU's family. If the
/// environment variables named below do not select this yet, sets them and restarts the program in
/// the same process, with the same arguments. Call this first in main(). It returns if no restart
/// is needed, or if the restart failed.
///
/// Sets OPENBLAS_CORETYPE (blasKernelsOf), unless the user set it, and OPENBLAS_NUM_THREADS=1,
/// because each thread of OpenBLAS takes 128 MiB of address space. Two kernels of equal speed can
/// give different bits (Cooperlake and SkylakeX in single precision), so all machines of a family
/// use the same kernels.
void chooseBlasKernels(char** argv);

/// Returns OpenBLAS's name of the kernels in use, such as "SkylakeX".
std::string blasKernels();

/// Returns whether a restarted process could use other kernels: this OpenBLAS contains several, and
/// the user did not set OPENBLAS_CORETYPE.
bool blasKernelsMayBeChosen();
/// Selects the kernels of the program that will replace this one (execve). Error if the environment
/// cannot be changed.
void chooseBlasKernelsOfNext(const std::string& kernels);

/// Returns why OpenBLAS does not use the kernels of this CPU's family, with the remedy. Empty if it
/// does.
std::string whyOtherBlasKernels();

/// Prepares OpenBLAS for use on any thread of this process: limits it to one thread of its own and
/// makes it allocate its workspace now. Only the first call does this. Every call throws an Error
/// if the system refused the memory.
void prepareBlas();

}  // namespace palpate
