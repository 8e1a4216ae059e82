#include "worker/elements/kernel_family.hpp"

#include <cstdlib>
#include <string_view>

#include "common/base/cpu_family.hpp"
#include "common/base/error.hpp"
#include "worker/elements/blas_kernels.hpp"

namespace palpate {

extern const ElementKernels kernels_of_baseline;
extern const ElementKernels kernels_of_avx2;
extern const ElementKernels kernels_of_avx512;

std::vector<const ElementKernels*> supportedKernels() {
  std::vector<const ElementKernels*> supported;
  if (cpuFamily() >= CpuFamily::avx512) supported.push_back(&kernels_of_avx512);
  if (cpuFamily() >= CpuFamily::avx2) supported.push_back(&kernels_of_avx2);
  supported.push_back(&kernels_of_baseline);
  return supported;
}

const ElementKernels& chooseKernels() {
  const auto supported = supportedKernels();
  const char* wanted = std::getenv("PALPATE_KERNELS");
  if (wanted == nullptr || *wanted == '\0') return *supported.front();
  std::string names;
  for (const ElementKernels* kernels : supported) {
    if (std::string_view(kernels->family) == wanted) return *kernels;
    names += names.empty() ? kernels->family : std::string(", ") + kernels->family;
  }
  throw badInput("PALPATE_KERNELS={}: this machine runs {}", wanted, names);
}

std::string arithmetic(const ElementKernels& kernels) {
  return std::string(kernels.family) + "/" + blasKernels();
}

}  // namespace palpate
