#include <array>

#include "common/base/program.hpp"
#include "worker/elements/blas_kernels.hpp"
#include "worker/verification/verify_command.hpp"

int main(int argc, char** argv) {
  palpate::chooseBlasKernels(argv);
  const std::array verbs = {palpate::verify_verb};
  return palpate::runProgram(argc, argv, "palpate-verify: what is known beside what is computed",
                             verbs);
}
