#include "scheduler/state/replay.hpp"

#include <gtest/gtest.h>

#include <chrono>

#include "tests/support/allocated_bytes.hpp"

namespace palpate {
namespace {

/// There may be ten million.
TEST(ResultIndex, TakesAboutTheMemoryThatIsSaidOfIt) {
  const auto before = test::allocatedBytes();
  if (!before) GTEST_SKIP() << "a sanitizer has a malloc of its own";
  // The table doubles: it is emptiest just behind that, and had just doubled at one of these.
  for (const std::int32_t count : {41000, 50000, 60000, 70000, 81000}) {
    ResultIndex index;
    for (std::int32_t n = 0; n < count; ++n)
      index.emplace(ResultKey{0, {n, 0, 0}, {n - 1, 0, 0}}, JournalPosition{1, 0, 1000});
    EXPECT_LT(static_cast<double>(*test::allocatedBytes() - *before) / count, 100) << count;
  }
}

/// Results of a build are those of neighbours on a lattice: if their hashes met, each look would go
/// through thousands.
TEST(ResultIndex, IsQuickForTheTransitionsOfALattice) {
  const auto begun = std::chrono::steady_clock::now();
  ResultIndex index;
  std::size_t count = 0;
  constexpr std::int32_t radius = 16;
  for (std::int32_t i = -radius; i < radius; ++i)
    for (std::int32_t j = -radius; j < radius; ++j)
      for (std::int32_t k = -radius; k < radius; ++k)
        for (const std::uint32_t space : {0u, 1u}) {
          // As a scene that refines counts: in 1024ths of the spacing.
          const ResultKey key{
              space, {1024 * i, 1024 * j, 1024 * k}, {1024 * (i - 1), 1024 * j, 1024 * k}};
          ASSERT_TRUE(index.emplace(key, JournalPosition{1, ++count, 1000}).second);
        }
  EXPECT_EQ(index.size(), count);
  EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(5)) << "it takes 20 ms";
}

}  // namespace
}  // namespace palpate
