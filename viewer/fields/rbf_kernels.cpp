#include "viewer/fields/rbf_kernels.hpp"

namespace palpate {

extern const RbfKernels rbf_kernels_of_baseline;
extern const RbfKernels rbf_kernels_of_avx2;
extern const RbfKernels rbf_kernels_of_avx512;

std::vector<const RbfKernels*> supportedRbfKernels() {
  std::vector<const RbfKernels*> supported;
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    supported.push_back(&rbf_kernels_of_avx512);
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    supported.push_back(&rbf_kernels_of_avx2);
  supported.push_back(&rbf_kernels_of_baseline);
  return supported;
}

}  // namespace palpate
