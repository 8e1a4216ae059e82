#include "common/base/cpu_family.hpp"

namespace palpate {

CpuFamily cpuFamily() {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return CpuFamily::baseline;
  const bool has_avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                          __builtin_cpu_supports("avx512vl");
  return has_avx512 ? CpuFamily::avx512 : CpuFamily::avx2;
}

}  // namespace palpate
