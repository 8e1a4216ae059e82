#define PALPATE_KERNEL_FAMILY "avx512"
#define PALPATE_KERNEL_NAMESPACE kernels_avx512
#define PALPATE_KERNELS kernels_of_avx512
#include "worker/elements/element_kernels_impl.hpp"
