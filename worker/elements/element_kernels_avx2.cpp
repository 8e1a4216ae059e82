#define PALPATE_KERNEL_NAMESPACE kernels_avx2
#include "worker/elements/element_kernels_impl.hpp"

namespace palpate {

extern const ElementKernels kernels_of_avx2;
const ElementKernels kernels_of_avx2 = {"avx2", kernels_avx2::residualKernel,
                                        kernels_avx2::tangentKernel};

}  // namespace palpate
