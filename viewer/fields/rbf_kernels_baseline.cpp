#define PALPATE_KERNEL_NAMESPACE rbf_kernels_baseline
#include "viewer/fields/rbf_kernels_impl.hpp"

namespace palpate {

extern const RbfKernels rbf_kernels_of_baseline;
const RbfKernels rbf_kernels_of_baseline = {"baseline", rbf_kernels_baseline::linear,
                                            rbf_kernels_baseline::cubic,
                                            rbf_kernels_baseline::hermite};

}  // namespace palpate
