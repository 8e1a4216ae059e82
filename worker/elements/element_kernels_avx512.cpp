#define PALPATE_KERNEL_NAMESPACE kernels_avx512
#include "worker/elements/element_kernels_impl.hpp"

namespace palpate {

extern const ElementKernels kernels_of_avx512;
const ElementKernels kernels_of_avx512 = {"avx512", kernels_avx512::residualKernel,
                                          kernels_avx512::tangentKernel};

}  // namespace palpate
