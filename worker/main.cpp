#include <array>

#include "worker/elements/blas_kernels.hpp"
#include "worker/verbs.hpp"

int main(int argc, char** argv) {
  using namespace palpate;
  chooseBlasKernels(argv);
  const std::array verbs = {check_verb, work_verb, solve_verb, kernels_verb};
  return runProgram(argc, argv, "palpate-worker: everything that solves", verbs);
}
