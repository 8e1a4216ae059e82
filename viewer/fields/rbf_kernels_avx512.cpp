#define PALPATE_KERNEL_NAMESPACE rbf_kernels_avx512
#include "viewer/fields/rbf_kernels_impl.hpp"

namespace palpate {

extern const RbfKernels rbf_kernels_of_avx512;
const RbfKernels rbf_kernels_of_avx512 = {"avx512", rbf_kernels_avx512::linear,
                                          rbf_kernels_avx512::cubic, rbf_kernels_avx512::hermite};

}  // namespace palpate
