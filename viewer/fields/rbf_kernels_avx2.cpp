#define PALPATE_KERNEL_NAMESPACE rbf_kernels_avx2
#include "viewer/fields/rbf_kernels_impl.hpp"

namespace palpate {

extern const RbfKernels rbf_kernels_of_avx2;
const RbfKernels rbf_kernels_of_avx2 = {"avx2", rbf_kernels_avx2::linear, rbf_kernels_avx2::cubic,
                                        rbf_kernels_avx2::hermite};

}  // namespace palpate
