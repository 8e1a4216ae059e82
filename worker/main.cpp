#include <array>

#include "common/base/program.hpp"
#include "worker/check_command.hpp"
#include "worker/elements/blas_kernels.hpp"
#include "worker/kernels_command.hpp"
#include "worker/solve_command.hpp"
#include "worker/work_command.hpp"

int main(int argc, char** argv) {
  palpate::chooseBlasKernels(argv);
  const std::array verbs = {palpate::check_verb, palpate::work_verb, palpate::solve_verb,
                            palpate::kernels_verb};
  return palpate::runProgram(argc, argv, "palpate-worker: everything that solves", verbs);
}
