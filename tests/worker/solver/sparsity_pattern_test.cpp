#include "worker/solver/sparsity_pattern.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace palpate {
namespace {

TEST(SparsityPattern, HasEachEntryOnceInOrder) {
  const SparsityPattern pattern = patternOf({{2, 0, 2, 1}, {1}, {2, 2}});
  EXPECT_EQ(pattern.n, 3);
  EXPECT_EQ(pattern.row, (std::vector<std::int32_t>{1, 1, 1, 2, 3}));
  EXPECT_EQ(pattern.column, (std::vector<std::int32_t>{1, 2, 3, 2, 3}));
  EXPECT_EQ(pattern.row_begin, (std::vector<std::int32_t>{0, 3, 4, 5}));
}

TEST(SparsityPattern, FindsAnEntryFromEitherSide) {
  const SparsityPattern pattern = patternOf({{0, 2}, {1}, {2}});
  EXPECT_EQ(pattern.entryOf(0, 2), 1);
  EXPECT_EQ(pattern.entryOf(2, 0), 1);
  EXPECT_EQ(pattern.entryOf(2, 2), 3);
  EXPECT_THROW(static_cast<void>(pattern.entryOf(0, 1)), std::logic_error);
}

TEST(SparsityPattern, IsNotMadeForAnUnknownThatOccursNowhere) {
  EXPECT_THROW(static_cast<void>(patternOf({{0}, {}})), std::logic_error);
}

}  // namespace
}  // namespace palpate
