#define PALPATE_KERNEL_FAMILY "baseline"
#define PALPATE_KERNEL_NAMESPACE kernels_baseline
#define PALPATE_KERNELS kernels_of_baseline
#include "worker/elements/element_kernels_impl.hpp"
