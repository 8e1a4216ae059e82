#include "scheduler/state/replay.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace palpate {
namespace {

/// Results of a build are transitions between lattice neighbours: if their hashes collided, each
/// lookup would visit thousands.
TEST(ResultIndex, IsFastForTheTransitionsOfALattice) {
  const auto begun = std::chrono::steady_clock::now();
  ResultIndex index;
  std::size_t count = 0;
  constexpr std::int32_t radius = 16;
  for (std::int32_t i = -radius; i < radius; ++i)
    for (std::int32_t j = -radius; j < radius; ++j)
      for (std::int32_t k = -radius; k < radius; ++k)
        for (const std::uint32_t space : {0u, 1u}) {
          // In adaptive scenes, lattice coordinates are in 1024ths of the spacing.
          const ResultKey key{
              space, {1024 * i, 1024 * j, 1024 * k}, {1024 * (i - 1), 1024 * j, 1024 * k}};
          ASSERT_TRUE(index.emplace(key, JournalPosition{1, ++count, 1000}).second);
        }
  EXPECT_EQ(index.size(), count);
  EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(5)) << "it takes 20 ms";
}

}  // namespace
}  // namespace palpate
