#include "worker/elements/kernel_family.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include "common/base/assertion.hpp"
#include "common/base/child_process.hpp"
#include "common/base/cpu_family.hpp"
#include "common/base/error.hpp"
#include "worker/elements/blas_kernels.hpp"

namespace palpate {

namespace {

constexpr const char* family_variable = "PALPATE_KERNELS";

/// Returns the family that the user chose; empty if none.
std::string_view chosenFamily() {
  const char* wanted = std::getenv(family_variable);
  return wanted == nullptr ? "" : wanted;
}

}  // namespace

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
  PALPATE_ASSERT(supported.front()->family == name(cpuFamily()),
                 "the first kernels must be those of this processor");
  const std::string_view wanted = chosenFamily();
  if (wanted.empty()) return *supported.front();
  std::string names;
  for (const ElementKernels* kernels : supported) {
    if (kernels->family == wanted) return *kernels;
    names += names.empty() ? kernels->family : std::string(", ") + kernels->family;
  }
  throw badInput("{}={}: this machine supports {}", family_variable, wanted, names);
}

std::string arithmetic(const ElementKernels& kernels) {
  return std::string(kernels.family) + "/" + blasKernels();
}

std::vector<std::string> otherArithmetic() {
  if (!chosenFamily().empty() || !blasKernelsMayBeChosen()) return {};
  std::vector<std::string> others;
  for (const CpuFamily family : all_cpu_families)
    if (family <= cpuFamily()) others.insert(others.begin(), arithmeticOf(family));
  std::erase(others, arithmetic(chooseKernels()));
  return others;
}

void beginAnewWith(const std::string& arithmetic) {
  const auto others = otherArithmetic();
  if (std::ranges::find(others, arithmetic) == others.end())
    throw failure("this process cannot switch to the {} kernels", arithmetic);
  const std::size_t slash = arithmetic.find('/');
  if (setenv(family_variable, arithmetic.substr(0, slash).c_str(), 1) != 0)
    throw failure("{}: {}", family_variable, errnoText());
  chooseBlasKernelsOfNext(arithmetic.substr(slash + 1));
  std::vector<std::string> words = commandLine();
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execv("/proc/self/exe", arguments.data());
  throw failure("cannot restart this program: {}", errnoText());
}

}  // namespace palpate
