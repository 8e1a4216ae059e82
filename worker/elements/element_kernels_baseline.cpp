#define PALPATE_KERNEL_NAMESPACE kernels_baseline
#include "worker/elements/element_kernels_impl.hpp"

namespace palpate {

extern const ElementKernels kernels_of_baseline;
const ElementKernels kernels_of_baseline = {"baseline", kernels_baseline::residualKernel,
                                            kernels_baseline::tangentKernel};

}  // namespace palpate
