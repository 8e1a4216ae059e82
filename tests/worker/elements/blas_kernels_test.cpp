#include "worker/elements/blas_kernels.hpp"

#include <cblas.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/command.hpp"
#include "worker/elements/kernel_family.hpp"

namespace palpate {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// What `palpate-worker kernels` prints in this environment.
std::string kernelsWith(const std::string& environment) {
  const auto result =
      test::runCommand("env " + environment + " " PALPATE_BIN_DIR "/palpate-worker kernels");
  EXPECT_EQ(result.exit_code, 0) << result.output;
  return result.output;
}

const std::string unset = "-u OPENBLAS_CORETYPE -u PALPATE_OPENBLAS_TRIED";

TEST(BlasKernels, AWorkerRunsTheFastestOfItsCpuThatComputeRight) {
  const std::string chosen = kernelsWith(unset);
  EXPECT_THAT(chosen, StartsWith(std::string(supportedKernels().front()->family) + "/"));
  EXPECT_EQ(chosen.find('\n') + 1, chosen.size()) << "slow: " << chosen;
  if (supportedKernels().front()->family != std::string("baseline")) {
    EXPECT_THAT(chosen, ::testing::Not(HasSubstr("Prescott")));
  }
}

TEST(BlasKernels, AUsersChoiceStaysAndIsToldToBeSlow) {
  const std::string chosen = kernelsWith("-u PALPATE_OPENBLAS_TRIED OPENBLAS_CORETYPE=Prescott");
  EXPECT_THAT(chosen, HasSubstr("/Prescott\n"));
  if (supportedKernels().front()->family != std::string("baseline")) {
    EXPECT_THAT(chosen, HasSubstr("OPENBLAS_CORETYPE=Prescott chose them"));
  }
}

TEST(BlasKernels, AreTriedOneAfterTheOtherAndNotForEver) {
  // As if all but the last had been tried; and more than there are.
  EXPECT_THAT(kernelsWith("OPENBLAS_CORETYPE=Prescott PALPATE_OPENBLAS_TRIED=3"),
              HasSubstr("/Prescott\n"));
  EXPECT_THAT(kernelsWith("OPENBLAS_CORETYPE=Prescott PALPATE_OPENBLAS_TRIED=9"),
              HasSubstr("/Prescott\n"));
}

/// `palpate-worker kernels` where so much address space is allowed. 124: it had to be ended.
test::CommandResult kernelsWithin(int kilobytes) {
  return test::runCommand(
      fmt::format("ulimit -v {}; timeout 60 env -u OPENBLAS_NUM_THREADS {}/palpate-worker kernels",
                  kilobytes, PALPATE_BIN_DIR));
}

TEST(BlasKernels, WhereMemoryIsLimitedOneThreadTakesItOrTheLimitIsNamed) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizer's own memory does not fit under the limit";
#endif
  const test::CommandResult enough = kernelsWithin(600000);
  EXPECT_EQ(enough.exit_code, 0) << enough.output;
  // Newer ones wait while they are loaded, before our first line; palpate sees to that.
  if (std::string_view(openblas_get_config()).find("0.3.21") == std::string_view::npos) return;
  const test::CommandResult too_little = kernelsWithin(200000);
  EXPECT_EQ(too_little.exit_code, 1) << too_little.output;
  EXPECT_THAT(too_little.output, HasSubstr("ulimit -v"));
}

TEST(BlasKernels, ArePartOfTheWordThatADatasetRecords) {
  EXPECT_THAT(arithmetic(chooseKernels()), EndsWith("/" + blasKernels()));
  EXPECT_NO_THROW(prepareBlas());
}

}  // namespace
}  // namespace palpate
