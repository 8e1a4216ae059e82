#include "worker/elements/kernel_family.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "common/base/cpu_family.hpp"
#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

TEST(KernelFamily, HasTheNameOfItsInstructionSet) {
  const auto supported = supportedKernels();
  ASSERT_EQ(supported.size(), static_cast<std::size_t>(cpuFamily()) + 1);
  for (std::size_t n = 0; n < supported.size(); ++n)
    EXPECT_EQ(supported[n]->family, name(all_cpu_families[supported.size() - 1 - n]));
}

TEST(KernelFamily, OffersOlderFamiliesUnlessTheUserChose) {
  // Ignore choices of the user who runs the tests.
  unsetenv("PALPATE_KERNELS");
  unsetenv("OPENBLAS_CORETYPE");
  const std::vector<std::string> others = otherArithmetic();
  EXPECT_EQ(std::ranges::count(others, arithmetic(chooseKernels())), 0);
  if (cpuFamily() > CpuFamily::baseline) {
    ASSERT_FALSE(others.empty());
    EXPECT_EQ(others.back(), arithmeticOf(CpuFamily::baseline));
  }
  setenv("PALPATE_KERNELS", "baseline", 1);
  EXPECT_TRUE(otherArithmetic().empty());
  unsetenv("PALPATE_KERNELS");
  test::expectError(ExitCode::failed, [] { beginAnewWith("nonsense/42"); }, {"nonsense/42"});
}

}  // namespace
}  // namespace palpate
