#include "scheduler/plan/compact_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/same_records.hpp"

namespace palpate {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

/// A possible result of a worker in which all numbers differ; a finger's result if `finger`.
PointRecord foundOf(double seed, bool finger = false, Tag tag = Tag::expandable) {
  double next = seed;
  const auto fill = [&](auto& values) {
    for (Eigen::Index n = 0; n < values.size(); ++n) values.data()[n] = next += 0.125;
  };
  PointRecord found;
  found.tag = tag;
  found.parent = static_cast<std::int32_t>(seed) + 1;
  found.equilibrium.energy = next += 0.125;
  found.equilibrium.min_det_F = next += 0.125;
  fill(found.equilibrium.force);
  fill(found.equilibrium.stiffness);
  if (finger) {
    fill(found.equilibrium.drive);
    fill(found.equilibrium.drive_stiffness);
    fill(found.equilibrium.drive_slope);
    fill(found.equilibrium.stiffness_by_p);
    fill(found.equilibrium.stiffness_by_s);
    fill(found.equilibrium.drive_slope_by_p);
  }
  found.residual = next += 0.125;
  const auto count = static_cast<std::int32_t>(seed);
  found.cost = {count + 2, count + 3, count + 4, 0.5};
  found.fields = ContentId::of(std::to_string(seed));
  return found;
}

void expectKept(const PointRecord& kept, const PointRecord& found) {
  test::expectSame(kept, found);
  EXPECT_EQ(kept.cost.seconds, 0) << "a worker's time is not part of a dataset";
}

FailedAttempt attemptAt(std::int32_t target, std::int32_t parent, Cause cause) {
  return {target, parent, {.cause = cause}};
}

/// The same counts, by visiting every point.
PointCounts countedAmong(const CompactPoints& points, std::int32_t first, std::int32_t end) {
  PointCounts counts;
  for (std::int32_t n = first; n < end; ++n) {
    const bool tried = !points.attempts(n).empty(), unknown = points.tag(n) == Tag::unknown;
    ++counts.of_tag.at(static_cast<std::size_t>(points.tag(n)));
    counts.attempts += std::ssize(points.attempts(n));
    if (tried && unknown) ++counts.unknown_tried;
    if (tried && !isSolved(points.tag(n))) ++counts.unsolved_tried;
  }
  return counts;
}

void expectEqualCounts(const PointCounts& told, const PointCounts& counted) {
  EXPECT_EQ(told.of_tag, counted.of_tag);
  EXPECT_EQ(told.attempts, counted.attempts);
  EXPECT_EQ(told.unknown_tried, counted.unknown_tried);
  EXPECT_EQ(told.unsolved_tried, counted.unsolved_tried);
}

/// Checks the counts, which are kept without visiting points, after any changes.
void expectCountsToBeTrue(const CompactPoints& points, std::int32_t uniform) {
  expectEqualCounts(points.uniform(), countedAmong(points, 0, uniform));
  expectEqualCounts(points.added(), countedAmong(points, uniform, points.size()));
  CountsOfCauses failed = {}, attempts = {};
  for (std::int32_t n = 0; n < points.size(); ++n) {
    if (points.tag(n) == Tag::failed) ++failed.at(static_cast<std::size_t>(points.cause(n)));
    for (const FailedAttempt& attempt : points.attempts(n))
      ++attempts.at(static_cast<std::size_t>(attempt.failure.cause));
  }
  EXPECT_EQ(points.failedPoints(), failed);
  EXPECT_EQ(points.failedAttempts(), attempts);
}

TEST(CompactPoints, AreUnknownUntilReported) {
  CompactPoints points(3);
  points.add();
  ASSERT_EQ(points.size(), 4);
  for (std::int32_t n = 0; n < 4; ++n) {
    expectKept(points.record(n), PointRecord());
    EXPECT_THAT(points.attempts(n), IsEmpty());
  }
  EXPECT_THAT(points.uniform().of_tag, ElementsAre(3, 0, 0, 0));
  EXPECT_THAT(points.added().of_tag, ElementsAre(1, 0, 0, 0));
  EXPECT_THAT(points.failedPoints(), Each(0));
  EXPECT_THAT(points.failedAttempts(), Each(0));
}

TEST(CompactPoints, ReturnSolutionsToTheLastBit) {
  for (const bool finger : {false, true}) {
    CompactPoints points(2);
    PointRecord found = foundOf(7, finger, Tag::terminating);
    found.equilibrium.energy = -0.0;
    points.solve(1, found);
    expectKept(points.record(1), found);
    EXPECT_TRUE(std::signbit(points.record(1).equilibrium.energy));
    EXPECT_EQ(points.tag(1), Tag::terminating);
    EXPECT_EQ(points.parent(1), found.parent);
    EXPECT_EQ(points.factorizations(1), found.cost.factorizations);
    EXPECT_EQ(points.fields(1), found.fields);
    EXPECT_EQ(points.equilibrium(1).force, found.equilibrium.force);
    expectKept(points.record(0), PointRecord());
  }
}

TEST(CompactPoints, KeepEachFingersConfigurationalForce) {
  CompactPoints points(4);
  points.solve(2, foundOf(20, true));
  points.solve(0, foundOf(10, true));
  points.solve(3, foundOf(30));
  points.solve(2, foundOf(40, true));
  expectKept(points.record(0), foundOf(10, true));
  expectKept(points.record(2), foundOf(40, true));
  expectKept(points.record(3), foundOf(30));
}

/// A neighbour may reach a point that others did not, and an equilibrium of lower energy replaces
/// an earlier one.
TEST(CompactPoints, ASolutionReplacesEverythingBefore) {
  CompactPoints points(1);
  points.fail(0, Cause::limit_point);
  points.solve(0, foundOf(50, true));
  points.solve(0, foundOf(60));
  expectKept(points.record(0), foundOf(60));
  EXPECT_THAT(points.uniform().of_tag, ElementsAre(0, 1, 0, 0));
  points.solve(0, foundOf(70, true, Tag::terminating));
  expectKept(points.record(0), foundOf(70, true, Tag::terminating));
  EXPECT_THAT(points.uniform().of_tag, ElementsAre(0, 0, 1, 0));
}

TEST(CompactPoints, KeepAttemptsInOrder) {
  CompactPoints points(2);
  points.add();
  FailedAttempt first = attemptAt(2, 1, Cause::wrong_inertia);
  first.failure.step_reached = 0.25;
  points.addAttempt(first);
  points.addAttempt(attemptAt(1, 0, Cause::not_finite));
  points.addAttempt(attemptAt(2, 0, Cause::inverted_element));
  points.solve(2, foundOf(1));
  ASSERT_THAT(points.attempts(2), SizeIs(2));
  EXPECT_EQ(points.attempts(2)[0].parent, 1);
  EXPECT_EQ(points.attempts(2)[0].failure.cause, Cause::wrong_inertia);
  EXPECT_EQ(points.attempts(2)[0].failure.step_reached, 0.25);
  EXPECT_EQ(points.attempts(2)[1].parent, 0);
  EXPECT_THAT(points.attempts(1), SizeIs(1));
  EXPECT_THAT(points.attempts(0), IsEmpty());
  EXPECT_EQ(points.uniform().attempts, 1);
  EXPECT_EQ(points.added().attempts, 2);
}

/// The points are so many that they need several pages of memory.
TEST(CompactPoints, StayDistinctInAnyNumber) {
  constexpr std::int32_t uniform = 8192, all = 12290;
  CompactPoints points(uniform);
  while (points.size() < all) points.add();
  for (std::int32_t n = 0; n < all; n += 2) points.solve(n, foundOf(n));
  for (std::int32_t n = 1; n < all; n += 4) points.fail(n, Cause::unreachable);
  const std::array tags = {Tag::expandable, Tag::failed, Tag::expandable, Tag::unknown};
  for (std::int32_t n = 0; n < all; ++n)
    ASSERT_EQ(points.tag(n), tags.at(static_cast<std::size_t>(n % 4))) << n;
  for (std::int32_t n = 0; n < all; n += 2) ASSERT_EQ(points.fields(n), foundOf(n).fields) << n;
  EXPECT_THAT(points.uniform().of_tag, ElementsAre(uniform / 4, uniform / 2, 0, uniform / 4));
  EXPECT_EQ(points.added().of(Tag::expandable), (all - uniform) / 2);
  expectCountsToBeTrue(points, uniform);
}

TEST(CompactPoints, AreNotSolvedByAFailure) {
  CompactPoints points(1);
  for (const Tag tag : {Tag::unknown, Tag::failed})
    EXPECT_THROW(points.solve(0, foundOf(1, false, tag)), std::logic_error);
  EXPECT_THAT(points.uniform().of_tag, ElementsAre(1, 0, 0, 0));
}

TEST(CompactPoints, StayCorrectlyCountedAfterAnyChanges) {
  constexpr std::int32_t uniform = 20;
  std::mt19937 random(7);
  CompactPoints points(uniform);
  for (int turn = 0; turn < 2000; ++turn) {
    const auto n = static_cast<std::int32_t>(random() % static_cast<std::uint32_t>(points.size()));
    const auto cause = static_cast<Cause>(1 + random() % 11);
    switch (random() % 8) {
      case 0: points.fail(n, cause); break;
      case 1: points.solve(n, foundOf(turn, random() % 2 == 0)); break;
      case 2: points.solve(n, foundOf(turn, random() % 2 == 0, Tag::terminating)); break;
      case 3:
        if (points.size() < 40) points.add();
        break;
      default: points.addAttempt(attemptAt(n, 0, cause));
    }
    if (turn % 20 == 0) expectCountsToBeTrue(points, uniform);
  }
  expectCountsToBeTrue(points, uniform);
}

}  // namespace
}  // namespace palpate
