#include "worker/elements/blas_kernels.hpp"

#include <cblas.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

#include "common/base/cpu_family.hpp"
#include "tests/support/command.hpp"
#include "worker/elements/kernel_family.hpp"

namespace palpate {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

/// The output of `palpate-worker kernels` in this environment.
std::string kernelsWith(const std::string& environment) {
  const auto result =
      test::runCommand("env " + environment + " " PALPATE_BIN_DIR "/palpate-worker kernels");
  EXPECT_EQ(result.exit_code, 0) << result.output;
  return result.output;
}

const std::string unset = "-u OPENBLAS_CORETYPE -u PALPATE_OPENBLAS_PINNED";

TEST(BlasKernels, MatchTheCpusFamilyInAWorker) {
  const std::string chosen = kernelsWith(unset);
  EXPECT_EQ(chosen, arithmeticOf(cpuFamily()) + "\n");
}

TEST(BlasKernels, ChosenByTheUserAreKeptAndReported) {
  const std::string chosen = kernelsWith("-u PALPATE_OPENBLAS_PINNED OPENBLAS_CORETYPE=Prescott");
  EXPECT_THAT(chosen, HasSubstr("/Prescott\n"));
  if (supportedKernels().front()->family != std::string("baseline")) {
    EXPECT_THAT(chosen, HasSubstr("OPENBLAS_CORETYPE=Prescott is set"));
  }
}

/// Entries in [-1, 1] that never repeat.
template <class Matrix>
Matrix sample(Eigen::Index rows, Eigen::Index columns) {
  return Matrix::NullaryExpr(rows, columns, [](Eigen::Index i, Eigen::Index j) {
    return static_cast<typename Matrix::Scalar>(std::sin(1.0 + 3.7 * double(i) + 11.3 * double(j)));
  });
}

/// Compares products and substitutions, in which MUMPS spends its time, with Eigen in double.
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
    // Diagonally dominant, so that errors come from rounding and not from conditioning.
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

/// OpenBLAS has separate kernels for small matrices. The larger sizes fill its blocks and leave
/// remainders.
TEST(BlasKernels, ComputeCorrectlyInThisProcess) {
  openblas_set_num_threads(1);
  for (const int n : {5, 48, 97}) {
    EXPECT_TRUE((computesRight<Eigen::MatrixXf, cblas_sgemm, cblas_strsm>(n))) << n;
    EXPECT_TRUE((computesRight<Eigen::MatrixXd, cblas_dgemm, cblas_dtrsm>(n))) << n;
  }
}

/// Runs this program again with those kernels.
TEST(BlasKernels, ComputeCorrectlyInEveryFamilyOfThisCpu) {
  const std::string self = std::filesystem::read_symlink("/proc/self/exe");
  for (const CpuFamily family : all_cpu_families) {
    if (family > cpuFamily()) continue;
    const auto result = test::runCommand(fmt::format(
        "OPENBLAS_CORETYPE={} '{}' --gtest_filter=BlasKernels.ComputeCorrectlyInThisProcess",
        blasKernelsOf(family), self));
    EXPECT_EQ(result.exit_code, 0) << blasKernelsOf(family) << ": " << result.output;
  }
}

/// Runs `palpate-worker kernels` with limited address space. Exit code 124 means that timeout(1)
/// had to end it.
test::CommandResult kernelsWithin(int kilobytes) {
  return test::runCommand(
      fmt::format("ulimit -v {}; timeout 60 env -u OPENBLAS_NUM_THREADS {}/palpate-worker kernels",
                  kilobytes, PALPATE_BIN_DIR));
}

TEST(BlasKernels, UnderAMemoryLimitUseOneThreadOrNameTheLimit) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizer's own memory does not fit under the limit";
#endif
  const test::CommandResult enough = kernelsWithin(600000);
  EXPECT_EQ(enough.exit_code, 0) << enough.output;
  // Newer versions hang while they are loaded, before our code runs; the `palpate` command prevents
  // that.
  if (std::string_view(openblas_get_config()).find("0.3.21") == std::string_view::npos) return;
  const test::CommandResult too_little = kernelsWithin(200000);
  EXPECT_EQ(too_little.exit_code, 1) << too_little.output;
  EXPECT_THAT(too_little.output, HasSubstr("ulimit -v"));
}

TEST(BlasKernels, ArePartOfTheRecordedArithmetic) {
  EXPECT_THAT(arithmetic(chooseKernels()), EndsWith("/" + blasKernels()));
  EXPECT_NO_THROW(prepareBlas());
}

}  // namespace
}  // namespace palpate
