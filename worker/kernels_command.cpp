#include "worker/elements/blas_kernels.hpp"
#include "worker/elements/kernel_family.hpp"
#include "worker/verbs.hpp"

namespace palpate {

const Verb kernels_verb = {"kernels", "The kernels that solve on this machine", [](CLI::App&) {
                             return std::function<ExitCode()>([] {
                               prepareBlas();
                               fmt::print("{}\n", arithmetic(chooseKernels()));
                               if (const std::string why = whyBlasIsSlow(); !why.empty())
                                 fmt::print("{}\n", why);
                               return ExitCode::done;
                             });
                           }};

}  // namespace palpate
