#include "scheduler/state/result_index.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <map>
#include <random>

#include "tests/support/allocated_bytes.hpp"

namespace palpate {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

JournalPosition placeOf(std::uint32_t number) {
  return {1 + number / 100, 1000 * std::uint64_t{number % 100}, 1000 + number};
}

/// The step from a neighbour along x.
ResultKey stepTo(std::int32_t i, std::int32_t j = 0, std::int32_t k = 0, std::uint32_t space = 0) {
  return {space, {i, j, k}, {i - 1, j, k}};
}

std::vector<std::pair<ResultKey, JournalPosition>> allOf(const ResultIndex& index) {
  std::vector<std::pair<ResultKey, JournalPosition>> all;
  index.forEach(
      [&](const ResultKey& key, const JournalPosition& where) { all.emplace_back(key, where); });
  return all;
}

TEST(ResultIndex, KnowsNothingInTheBeginning) {
  ResultIndex index;
  EXPECT_EQ(index.size(), 0u);
  EXPECT_FALSE(index.contains({}));
  index.erase({});
  EXPECT_EQ(index.size(), 0u);
  EXPECT_THAT(allOf(index), IsEmpty());
}

TEST(ResultIndex, TellsKeysApartThatDifferInOneNumber) {
  const ResultKey key = {3, {10, -20, 30}, {9, -20, 31}};
  std::vector<ResultKey> others;
  // So many that some are looked for in the place of another.
  for (std::int32_t step = 1; step < 60; ++step) {
    const std::int32_t by = step < 30 ? step : -(1 << (step - 30));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      others.push_back(key);
      others.back().target.at(axis) += by;
      others.push_back(key);
      others.back().parent.at(axis) += by;
    }
    others.push_back(key);
    others.back().space += static_cast<std::uint32_t>(by);
  }
  others.push_back({key.space, key.parent, key.target});
  others.push_back({key.space, {-10, 20, -30}, {-9, 20, -31}});
  ResultIndex index;
  EXPECT_TRUE(index.add(key, placeOf(7)));
  EXPECT_EQ(index.find(key), placeOf(7));
  for (const ResultKey& other : others) EXPECT_FALSE(index.contains(other));
  for (std::uint32_t n = 0; n < others.size(); ++n) EXPECT_TRUE(index.add(others[n], placeOf(n)));
  for (std::uint32_t n = 0; n < others.size(); ++n) EXPECT_EQ(index.find(others[n]), placeOf(n));
  EXPECT_EQ(index.find(key), placeOf(7));
}

/// Of two records with the same key the first counts.
TEST(ResultIndex, KeepsTheFirstOfAKey) {
  ResultIndex index;
  EXPECT_TRUE(index.add(stepTo(1), placeOf(1)));
  EXPECT_FALSE(index.add(stepTo(1), placeOf(2)));
  EXPECT_EQ(index.find(stepTo(1)), placeOf(1));
  EXPECT_EQ(index.size(), 1u);
  EXPECT_THAT(allOf(index), ElementsAre(std::pair(stepTo(1), placeOf(1))));
}

TEST(ResultIndex, IsGoneThroughInTheOrderOfAdding) {
  ResultIndex index;
  std::vector<std::pair<ResultKey, JournalPosition>> added;
  for (std::uint32_t n = 0; n < 1000; ++n) {
    // In no order of keys, and not of places either: a journal that was mended has gaps.
    const ResultKey key = stepTo(static_cast<std::int32_t>(n * 389 % 1000) - 500);
    added.emplace_back(key, placeOf(n * 7 % 1000));
    index.add(key, added.back().second);
  }
  EXPECT_EQ(allOf(index), added);
  std::erase_if(added, [&](const auto& entry) {
    if (entry.first.target[0] % 3 != 0) return false;
    index.erase(entry.first);
    return true;
  });
  EXPECT_EQ(allOf(index), added);
  EXPECT_EQ(index.size(), added.size());
}

TEST(ResultIndex, WhatWasErasedIsNotThereAndCanBeAddedElsewhere) {
  ResultIndex index;
  for (const int n : {1, 2, 3}) index.add(stepTo(n), placeOf(static_cast<std::uint32_t>(n)));
  index.erase(stepTo(2));
  EXPECT_FALSE(index.contains(stepTo(2)));
  EXPECT_EQ(index.size(), 2u);
  EXPECT_TRUE(index.add(stepTo(2), placeOf(9)));
  EXPECT_FALSE(index.add(stepTo(2), placeOf(10)));
  EXPECT_EQ(index.find(stepTo(2)), placeOf(9));
  EXPECT_THAT(allOf(index),
              ElementsAre(std::pair(stepTo(1), placeOf(1)), std::pair(stepTo(3), placeOf(3)),
                          std::pair(stepTo(2), placeOf(9))))
      << "it came last";
}

TEST(ResultIndex, ErasingWhatIsNotThereChangesNothing) {
  ResultIndex index;
  index.add(stepTo(1), placeOf(1));
  index.erase(stepTo(2));
  EXPECT_EQ(index.size(), 1u);
  index.erase(stepTo(1));
  index.erase(stepTo(1));
  EXPECT_EQ(index.size(), 0u);
}

/// Those that share a place in the table with one that is gone lie behind it.
TEST(ResultIndex, FindsEveryOtherOneWhicheverIsErased) {
  constexpr std::int32_t count = 400;
  ResultIndex whole;
  for (std::int32_t n = 0; n < count; ++n)
    whole.add(stepTo(n), placeOf(static_cast<std::uint32_t>(n)));
  for (std::int32_t gone = 0; gone < count; ++gone) {
    ResultIndex index = whole;
    index.erase(stepTo(gone));
    for (std::int32_t n = 0; n < count; ++n)
      ASSERT_EQ(index.contains(stepTo(n)), n != gone) << n << " without " << gone;
  }
  for (std::int32_t n = 0; n < count; ++n) ASSERT_TRUE(whole.contains(stepTo(n))) << "of its own";
}

/// A record that is damaged again and again on a bad disk.
TEST(ResultIndex, HasRoomForEverThoughTheSameOneComesAndGoes) {
  ResultIndex index;
  index.add(stepTo(-1), placeOf(0));
  for (std::uint32_t n = 1; n < 5000; ++n) {
    ASSERT_TRUE(index.add(stepTo(5), placeOf(n)));
    ASSERT_EQ(index.find(stepTo(5)), placeOf(n));
    index.erase(stepTo(5));
    ASSERT_FALSE(index.contains(stepTo(5))) << "nor any of those before";
  }
  EXPECT_THAT(allOf(index), ElementsAre(std::pair(stepTo(-1), placeOf(0))));
}

TEST(ResultIndex, AgreesWithAMapWhateverIsAddedAndErased) {
  std::mt19937 random(3);
  ResultIndex index;
  std::map<ResultKey, JournalPosition> map;
  for (std::uint32_t turn = 1; turn < 20000; ++turn) {
    const auto any = [&] { return static_cast<std::int32_t>(random() % 5) - 2; };
    const ResultKey key = {
        static_cast<std::uint32_t>(random() % 2), {any(), any(), any()}, {any(), 0, 0}};
    if (random() % 3 == 0) {
      index.erase(key);
      map.erase(key);
    } else {
      const bool first = map.emplace(key, placeOf(turn)).second;
      ASSERT_EQ(index.add(key, placeOf(turn)), first);
    }
    ASSERT_EQ(index.size(), map.size());
    const ResultKey asked = {0, {any(), any(), any()}, {any(), 0, 0}};
    const auto there = map.find(asked);
    ASSERT_EQ(index.find(asked), there == map.end() ? std::nullopt : std::optional(there->second));
  }
  const auto all = allOf(index);
  EXPECT_EQ((std::map<ResultKey, JournalPosition>(all.begin(), all.end())), map);
  EXPECT_EQ(all.size(), map.size());
}

TEST(ResultIndex, ACopyIsChangedWithoutTheOther) {
  ResultIndex index;
  index.add(stepTo(1), placeOf(1));
  ResultIndex copy = index;
  copy.erase(stepTo(1));
  copy.add(stepTo(2), placeOf(2));
  EXPECT_THAT(allOf(index), ElementsAre(std::pair(stepTo(1), placeOf(1))));
  EXPECT_THAT(allOf(copy), ElementsAre(std::pair(stepTo(2), placeOf(2))));
}

TEST(ResultIndex, TakesNoPlaceThatIsInNoSegment) {
  ResultIndex index;
  EXPECT_THROW(index.add(stepTo(1), {0, 0, 100}), std::logic_error);
  EXPECT_FALSE(index.contains(stepTo(1)));
}

/// There may be ten million.
TEST(ResultIndex, TakesAboutTheMemoryThatIsSaidOfIt) {
  const auto before = test::allocatedBytes();
  if (!before) GTEST_SKIP() << "a sanitizer has a malloc of its own";
  // The table doubles: it is emptiest just behind that, and had just doubled at one of these.
  for (const std::int32_t count : {41000, 50000, 60000, 70000, 81000}) {
    ResultIndex index;
    for (std::int32_t n = 0; n < count; ++n) index.add(stepTo(n), placeOf(0));
    EXPECT_LT(static_cast<double>(*test::allocatedBytes() - *before) / count, 75) << count;
  }
}

/// Results of a build are those of neighbours on a lattice: if their hashes met, each look would go
/// through thousands.
TEST(ResultIndex, IsQuickForTheTransitionsOfALattice) {
  const auto begun = std::chrono::steady_clock::now();
  ResultIndex index;
  std::uint32_t count = 0;
  constexpr std::int32_t radius = 16;
  for (std::int32_t i = -radius; i < radius; ++i)
    for (std::int32_t j = -radius; j < radius; ++j)
      for (std::int32_t k = -radius; k < radius; ++k)
        for (const std::uint32_t space : {0u, 1u})
          // As a scene that refines counts: in 1024ths of the spacing.
          ASSERT_TRUE(index.add(
              {space, {1024 * i, 1024 * j, 1024 * k}, {1024 * (i - 1), 1024 * j, 1024 * k}},
              placeOf(count++)));
  EXPECT_EQ(index.size(), count);
  EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(5)) << "it takes 20 ms";
}

}  // namespace
}  // namespace palpate
