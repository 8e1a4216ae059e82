#include "worker/elements/blas_kernels.hpp"

#include <cblas.h>
#include <strings.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/cpu_family.hpp"
#include "common/base/error.hpp"

namespace palpate {
namespace {

constexpr const char* core_type = "OPENBLAS_CORETYPE";
/// Set with it by chooseBlasKernels: how many of fastestFirst() were tried. Without it, a value of
/// core_type is the user's.
constexpr const char* tried_variable = "PALPATE_OPENBLAS_TRIED";

/// Read while OpenBLAS is loaded: each of its threads takes `workspace` at once.
constexpr const char* threads_variable = "OPENBLAS_NUM_THREADS";
/// What a thread's first product takes, bytes: 128 MiB and its alignment.
constexpr std::size_t workspace = (128u << 20) + (64u << 10);
/// The first products take milliseconds; OpenBLAS may wait for ever in them.
constexpr unsigned first_products_limit_s = 60;

/// What this CPU runs, by the names of OpenBLAS.
std::vector<std::string> fastestFirst() {
  std::vector<std::string> all;
  for (const CpuFamily family : all_cpu_families)
    if (family <= cpuFamily()) all.emplace(all.begin(), blasKernelsOf(family));
  return all;
}

/// 0 without AVX2, 1 with, 2 with AVX-512. A name that is not listed is newer than this list.
int levelOf(const std::string& kernels) {
  constexpr std::array with_avx2 = {"Haswell", "Zen", "Excavator"};
  constexpr std::array older = {"Katmai",   "Coppermine", "Northwood",    "Banias",
                                "Prescott", "Core2",      "Penryn",       "Dunnington",
                                "Nehalem",  "Atom",       "Nano",         "Sandybridge",
                                "Athlon",   "Opteron",    "Opteron_SSE3", "Barcelona",
                                "Bobcat",   "Bulldozer",  "Piledriver",   "Steamroller"};
  const auto isOneOf = [&](const auto& names) {
    return std::any_of(names.begin(), names.end(),
                       [&](const char* name) { return strcasecmp(name, kernels.c_str()) == 0; });
  };
  return isOneOf(older) ? 0 : isOneOf(with_avx2) ? 1 : 2;
}

bool choosesWhenLoaded() {
  return std::string_view(openblas_get_config()).find("DYNAMIC_ARCH") != std::string_view::npos;
}

/// Entries in [-1, 1] that repeat nowhere.
template <class Matrix>
Matrix sample(Eigen::Index rows, Eigen::Index columns) {
  return Matrix::NullaryExpr(rows, columns, [](Eigen::Index i, Eigen::Index j) {
    return static_cast<typename Matrix::Scalar>(std::sin(1.0 + 3.7 * double(i) + 11.3 * double(j)));
  });
}

/// Products and substitutions, what MUMPS spends its time in, against Eigen's own in double.
template <class Matrix, auto gemm, auto trsm>
bool computesRight(int n) {
  const int columns = n + 3, inner = 2 * n + 1;
  const double tolerance = 8.0 * inner * std::numeric_limits<typename Matrix::Scalar>::epsilon();
  const auto isSmall = [&](const Eigen::MatrixXd& difference) {
    return difference.allFinite() && difference.cwiseAbs().maxCoeff() <= tolerance;
  };
  const auto A = sample<Matrix>(n, inner), B = sample<Matrix>(inner, columns);
  const auto stored = [](const Matrix& matrix, CBLAS_TRANSPOSE as) {
    return as == CblasTrans ? Matrix(matrix.transpose()) : matrix;
  };
  const Eigen::MatrixXd product = A.template cast<double>() * B.template cast<double>();
  for (const CBLAS_TRANSPOSE a : {CblasNoTrans, CblasTrans})
    for (const CBLAS_TRANSPOSE b : {CblasNoTrans, CblasTrans}) {
      const Matrix left = stored(A, a), right = stored(B, b);
      Matrix C = Matrix::Zero(n, columns);
      gemm(CblasColMajor, a, b, n, columns, inner, 1, left.data(), int(left.rows()), right.data(),
           int(right.rows()), 0, C.data(), n);
      if (!isSmall(C.template cast<double>() - product)) return false;
    }
  for (const CBLAS_TRANSPOSE l : {CblasNoTrans, CblasTrans}) {
    // Dominated by its diagonal, so that what is lost is rounding and not conditioning.
    Matrix L = sample<Matrix>(n, n) / static_cast<typename Matrix::Scalar>(n);
    L.diagonal().setConstant(2);
    L.template triangularView<Eigen::StrictlyUpper>().setZero();
    const Matrix right = sample<Matrix>(n, columns);
    Matrix X = right;
    trsm(CblasColMajor, CblasLeft, CblasLower, l, CblasNonUnit, n, columns, 1, L.data(), n,
         X.data(), n);
    Eigen::MatrixXd matrix = L.template cast<double>();
    if (l == CblasTrans) matrix.transposeInPlace();
    if (!isSmall(matrix * X.template cast<double>() - right.template cast<double>())) return false;
  }
  return true;
}

/// Whether the system grants the workspace. Where it does not, OpenBLAS asks again for ever.
bool workspaceIsGranted() {
  static const bool granted = [] {
    void* const room =
        mmap(nullptr, workspace, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return room != MAP_FAILED && munmap(room, workspace) == 0;
  }();
  return granted;
}

/// What keeps the workspace from this process, and the remedy.
std::string whyNotGranted() {
  for (const auto& [resource, option] :
       {std::pair{RLIMIT_AS, "-v"}, std::pair{RLIMIT_DATA, "-d"}}) {
    struct rlimit limit {};
    if (getrlimit(resource, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
      return fmt::format("its limit is {} MiB (ulimit {}): raise it to 1000 MiB or more",
                         limit.rlim_cur >> 20, option);
  }
  return "free memory, or let the system overcommit (sysctl vm.overcommit_memory=0)";
}

[[noreturn]] void onSilence(int) {
  constexpr std::string_view sentence =
      "OpenBLAS did not compute its first product within a minute: give this process more memory, "
      "or update OpenBLAS\n";
  if (write(STDERR_FILENO, sentence.data(), sentence.size()) < 0) _exit(125);
  _exit(1);
}

/// Small matrices have kernels of their own; the others fill blocks and leave edges.
bool firstProductsAreRight() {
  constexpr std::array sizes = {5, 48, 97};
  std::signal(SIGALRM, onSilence);
  alarm(first_products_limit_s);
  const bool right = std::all_of(sizes.begin(), sizes.end(), [](int n) {
    return computesRight<Eigen::MatrixXf, cblas_sgemm, cblas_strsm>(n) &&
           computesRight<Eigen::MatrixXd, cblas_dgemm, cblas_dtrsm>(n);
  });
  alarm(0);
  return right;
}

/// Call after workspaceIsGranted().
bool blasComputesRight() {
  openblas_set_num_threads(1);  // what prepareBlas() promises, too
  static const bool right = firstProductsAreRight();
  return right;
}

/// Puts this program into its process again, with the environment as it is now. Returns when that
/// fails.
void startAnew(char** argv) {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (!error) execv(program.c_str(), argv);
}

}  // namespace

bool blasKernelsMayBeChosen() {
  return choosesWhenLoaded() &&
         (std::getenv(tried_variable) != nullptr || std::getenv(core_type) == nullptr);
}

void chooseBlasKernelsOfNext(const std::string& kernels) {
  if (setenv(core_type, kernels.c_str(), 1) != 0 || unsetenv(tried_variable) != 0)
    throw failure("{}={}: {}", core_type, kernels, errnoText());
}

void chooseBlasKernels(char** argv) {
  const char* threads = std::getenv(threads_variable);
  if ((threads == nullptr || threads != std::string_view("1")) &&
      setenv(threads_variable, "1", 1) == 0)
    startAnew(argv);
  const char* tried = std::getenv(tried_variable);
  // Without workspace prepareBlas says so when something is to be computed.
  if (!blasKernelsMayBeChosen() || !workspaceIsGranted()) return;
  const std::vector<std::string> wanted = fastestFirst();
  const auto next = static_cast<std::size_t>(tried == nullptr ? 0 : std::atoi(tried));
  const std::string& meant = wanted[std::min(next == 0 ? 0 : next - 1, wanted.size() - 1)];
  if (strcasecmp(blasKernels().c_str(), meant.c_str()) == 0 && blasComputesRight()) return;
  // Wrong to the last: prepareBlas says so when something is to be computed.
  if (next >= wanted.size()) return;
  if (setenv(core_type, wanted[next].c_str(), 1) == 0 &&
      setenv(tried_variable, std::to_string(next + 1).c_str(), 1) == 0)
    startAnew(argv);
  // Not replaced, so this process goes on with the kernels it has, and nobody chose them.
  unsetenv(core_type);
  unsetenv(tried_variable);
}

std::string blasKernels() { return openblas_get_corename(); }

std::string whyBlasIsSlow() {
  const std::string fastest = fastestFirst().front();
  if (levelOf(blasKernels()) >= levelOf(fastest)) return "";
  if (!choosesWhenLoaded())
    return fmt::format("this OpenBLAS is built for {} alone: install one with DYNAMIC_ARCH",
                       blasKernels());
  if (const char* chosen = std::getenv(core_type);
      chosen != nullptr && !std::getenv(tried_variable))
    return fmt::format(
        "{}={} chose them, this CPU runs {}: unset it, unless an older dataset is to be reproduced",
        core_type, chosen, fastest);
  return fmt::format("this OpenBLAS has no kernels like {} that compute right here: update it",
                     fastest);
}

void prepareBlas() {
  if (!workspaceIsGranted())
    throw failure("OpenBLAS needs {} MiB more than the system grants this process: {}",
                  workspace >> 20, whyNotGranted());
  if (!blasComputesRight())
    throw failure(
        "OpenBLAS computes wrong products with its {} kernels on this CPU: choose others with {}, "
        "or update it",
        blasKernels(), core_type);
}

}  // namespace palpate
