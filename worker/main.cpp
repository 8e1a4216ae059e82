#include <array>
#include <cstdlib>

#include "worker/elements/blas_kernels.hpp"
#include "worker/elements/kernel_family.hpp"
#include "worker/verbs.hpp"

namespace {

using namespace palpate;

ExitCode printKernels() {
  prepareBlas();
  fmt::print("{}\n", arithmetic(chooseKernels()));
  if (const std::string why = whyOtherBlasKernels(); !why.empty()) fmt::print("{}\n", why);
  return ExitCode::done;
}

/// `palpate-worker kernels`: prints the kernels with which this machine solves ("avx512/SkylakeX").
/// If they are not the kernels of the CPU's family, a second line says why. `palpate doctor` runs
/// this command, because it has no OpenBLAS itself. Exit 1 if the system refuses OpenBLAS memory.
const Verb kernels_verb = {"kernels", "Print the solver kernels of this machine",
                           [](CLI::App&) { return std::function<ExitCode()>(printKernels); }};

}  // namespace

int main(int argc, char** argv) {
  chooseBlasKernels(argv);
  const std::array verbs = {mesh_verb,  new_verb,    check_verb,  work_verb,
                            solve_verb, follow_verb, kernels_verb};
  const int code = runProgram(argc, argv, "palpate-worker: meshing, checking and solving", verbs);
  if (solver_left_running) std::_Exit(code);
  return code;
}
