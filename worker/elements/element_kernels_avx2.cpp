#define PALPATE_KERNEL_FAMILY "avx2"
#define PALPATE_KERNEL_NAMESPACE kernels_avx2
#define PALPATE_KERNELS kernels_of_avx2
#include "worker/elements/element_kernels_impl.hpp"
