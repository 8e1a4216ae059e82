#include "worker/elements/blas_kernels.hpp"

#include <cblas.h>
#include <strings.h>
#include <unistd.h>

#include <Eigen/Core>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "common/base/cpu_family.hpp"
#include "common/base/error.hpp"
#include "common/base/machine.hpp"

namespace palpate {
namespace {

/// Environment variables that OpenBLAS reads while it is loaded.
constexpr const char* core_type = "OPENBLAS_CORETYPE";
constexpr const char* threads_variable = "OPENBLAS_NUM_THREADS";
/// Environment variable that holds the value to which chooseBlasKernels set core_type. If core_type
/// has another value, the user set it.
constexpr const char* pinned_variable = "PALPATE_OPENBLAS_PINNED";

/// Smallest memory for solving, bytes: OpenBLAS's workspace of 128 MiB, and as much for the stacks
/// of threads and a small body. If OpenBLAS cannot get its workspace, it retries forever.
constexpr std::size_t needed = 256u << 20;

std::string kernelsOfThisCpu() { return std::string(blasKernelsOf(cpuFamily())); }

std::string environmentValue(const char* variable) {
  const char* value = std::getenv(variable);
  return value == nullptr ? "" : value;
}

bool userChose() {
  const std::string chosen = environmentValue(core_type);
  return !chosen.empty() && chosen != environmentValue(pinned_variable);
}

bool choosesWhenLoaded() {
  return std::string_view(openblas_get_config()).find("DYNAMIC_ARCH") != std::string_view::npos;
}

/// Multiplies two matrices, so that OpenBLAS allocates its workspace. The matrices need more than
/// 100 rows: with AVX-512, OpenBLAS multiplies smaller ones without a workspace.
void takeWorkspace() {
  constexpr int n = 128;
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd product(n, n);
  cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, n, n, n, 1, one.data(), n, one.data(), n,
              0, product.data(), n);
}

}  // namespace

bool blasKernelsMayBeChosen() { return choosesWhenLoaded() && !userChose(); }

void chooseBlasKernelsOfNext(const std::string& kernels) {
  if (setenv(core_type, kernels.c_str(), 1) != 0 || unsetenv(pinned_variable) != 0)
    throw failure("{}={}: {}", core_type, kernels, errnoText());
}

void chooseBlasKernels(char** argv) {
  const std::string wanted = kernelsOfThisCpu();
  // A core type that this function set on another CPU may still be in the environment. It is
  // replaced too.
  const bool pins = choosesWhenLoaded() && !userChose() && environmentValue(core_type) != wanted;
  if (!pins && environmentValue(threads_variable) == "1") return;
  const bool set = setenv(threads_variable, "1", 1) == 0 &&
                   (!pins || (setenv(core_type, wanted.c_str(), 1) == 0 &&
                              setenv(pinned_variable, wanted.c_str(), 1) == 0));
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (set && !error) execv(program.c_str(), argv);
  // The restart failed. This process continues with the kernels that OpenBLAS chose, so core_type
  // must not name other kernels.
  if (pins) unsetenv(core_type);
}

std::string blasKernels() { return openblas_get_corename(); }

std::string whyOtherBlasKernels() {
  const std::string wanted = kernelsOfThisCpu();
  if (strcasecmp(blasKernels().c_str(), wanted.c_str()) == 0) return "";
  if (!choosesWhenLoaded())
    return fmt::format("this OpenBLAS is built only for {}; install one with DYNAMIC_ARCH",
                       blasKernels());
  if (userChose())
    return fmt::format(
        "{}={} is set, but this CPU supports {}; unset it, unless you reproduce an older dataset",
        core_type, environmentValue(core_type), wanted);
  return fmt::format("this OpenBLAS runs the {} kernels, but this CPU supports {}; update OpenBLAS",
                     blasKernels(), wanted);
}

void prepareBlas() {
  // An initialisation that throws is tried again by the next call.
  [[maybe_unused]] static const bool prepared = [] {
    openblas_set_num_threads(1);
    requireMemory(needed);
    takeWorkspace();  // before other allocations take that memory
    return true;
  }();
}

}  // namespace palpate
