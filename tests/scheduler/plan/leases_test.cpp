#include "scheduler/plan/leases.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

using testing::ElementsAre;

/// The transition between two points of the first axis with these distances from the origin.
ResultKey way(std::uint32_t space, std::int32_t target, std::int32_t parent) {
  return {space, {target, 0, 0}, {parent, 0, 0}};
}

/// The distances from the origin of a job's targets.
std::vector<std::int32_t> targetsOf(const Handout& job) {
  std::vector<std::int32_t> targets;
  for (const ResultKey& key : job.targets) targets.push_back(key.target[0]);
  return targets;
}
std::int32_t parentOf(const Handout& job) { return job.targets.front().parent[0]; }
std::uint32_t spaceOf(const Handout& job) { return job.targets.front().space; }

struct LeasesTest : testing::Test {
  Leases leases;

  void addTargets(std::int32_t parent, std::int32_t first, std::int32_t count,
                  std::uint32_t space = 0) {
    for (std::int32_t n = 0; n < count; ++n) leases.add(way(space, first + n, parent));
  }
  Handout handOut(const std::string& worker, std::size_t workers = 1) {
    return leases.handOut(worker, workers).value();
  }
  /// Ends the worker's process. Returns the transitions under suspicion.
  std::vector<ResultKey> die(const std::string& worker, std::optional<ResultKey> solving) {
    const Leases::Suspects suspects = leases.suspectsOf(worker, solving);
    leases.giveBack(worker);
    std::vector<ResultKey> keys;
    for (const auto& [key, losses] : leases.blame(suspects)) keys.push_back(key);
    return keys;
  }
  /// How often the last target of the worker's next job was handed out.
  std::uint32_t attemptsOfNext(const std::string& worker) {
    handOut(worker);
    return leases.lastOf(worker).value().attempts;
  }
};

TEST_F(LeasesTest, AJobHoldsTargetsAroundTheStartNearestToTheOrigin) {
  addTargets(5, 20, 2);
  addTargets(3, 10, 2);
  const Handout job = handOut("a");
  EXPECT_EQ(parentOf(job), 3);
  EXPECT_THAT(targetsOf(job), ElementsAre(10, 11));
  EXPECT_EQ(parentOf(handOut("a")), 5);
  EXPECT_EQ(parentOf(handOut("a")), 5);
  EXPECT_FALSE(leases.handOut("a", 1));
}

TEST_F(LeasesTest, WorkIsSplitSoThatEveryWorkerGetsSome) {
  addTargets(0, 1, 26);
  EXPECT_EQ(handOut("a", 2).targets.size(), 7u);
  EXPECT_EQ(handOut("b", 2).targets.size(), 5u);
  addTargets(1, 100, 1000);
  EXPECT_EQ(handOut("a", 2).targets.size(), 14u) << "what is left around start 0";
  EXPECT_EQ(handOut("b", 2).targets.size(), max_targets_per_job);
}

TEST_F(LeasesTest, SpacesDoNotMix) {
  addTargets(0, 1, 3, 0);
  addTargets(0, 1, 3, 1);
  EXPECT_EQ(spaceOf(handOut("a")), 0u);
  EXPECT_EQ(spaceOf(handOut("a")), 1u);
}

TEST_F(LeasesTest, JobNumbersContinueAfterTheFirst) {
  Leases later(7ull << 32);
  later.add(way(0, 0, 0));
  EXPECT_EQ(later.handOut("a", 1)->job, (7ull << 32) + 1);
}

TEST_F(LeasesTest, ALostWorkersTargetsAreHandedOutAgainAndCounted) {
  addTargets(0, 1, 1);
  EXPECT_EQ(attemptsOfNext("a"), 1u);
  leases.giveBack("a");
  EXPECT_EQ(leases.waiting(), 1u);
  EXPECT_EQ(attemptsOfNext("b"), 2u);
}

TEST_F(LeasesTest, AFinishedTargetIsNotHandedOutAgain) {
  addTargets(0, 1, 2);
  handOut("a");
  handOut("a");
  leases.finish(way(0, 1, 0));
  EXPECT_EQ(leases.leasedTo("a"), 1u);
  leases.giveBack("a");
  EXPECT_EQ(leases.waiting(), 1u);
  leases.finish(way(0, 2, 0));
  EXPECT_EQ(leases.waiting(), 0u);
  EXPECT_TRUE(leases.empty());
}

TEST_F(LeasesTest, ATargetLostTwiceIsHandedOutAlone) {
  addTargets(0, 1, 3);
  for (const char* worker : {"a", "b"}) {
    EXPECT_EQ(handOut(worker).targets.size(), 2u);
    die(worker, way(0, 2, 0));
  }
  // At both deaths, target 1 was next in order, and target 2 was named by the last heartbeat.
  EXPECT_THAT(targetsOf(handOut("c")), ElementsAre(1));
  EXPECT_THAT(targetsOf(handOut("c")), ElementsAre(2));
  EXPECT_THAT(targetsOf(handOut("c")), ElementsAre(3));
}

TEST_F(LeasesTest, ATargetThatKillsFiveWorkersIsSetAsideUntilItIsRetried) {
  addTargets(0, 1, 1);
  for (int death = 1; death <= deaths_before_aside; ++death) {
    EXPECT_FALSE(leases.stuck());
    handOut("a");
    EXPECT_THAT(die("a", way(0, 1, 0)), ElementsAre(way(0, 1, 0)));
  }
  EXPECT_EQ(leases.waiting(), 0u);
  EXPECT_THAT(leases.aside(), ElementsAre(way(0, 1, 0)));
  EXPECT_TRUE(leases.stuck());
  EXPECT_FALSE(leases.handOut("a", 1));
  leases.retry();
  EXPECT_TRUE(leases.aside().empty());
  EXPECT_EQ(attemptsOfNext("a"), deaths_before_aside + 1u);
}

TEST_F(LeasesTest, HistoryOfEarlierRunsCounts) {
  leases.add(way(0, 1, 0), {.attempts = 9, .suspected = 5, .deaths = deaths_before_aside});
  leases.add(way(0, 2, 0), {.attempts = 3, .suspected = 0, .deaths = deaths_before_aside - 1});
  EXPECT_EQ(leases.aside().size(), 1u);
  EXPECT_EQ(attemptsOfNext("a"), 4u);
  die("a", way(0, 2, 0));
  EXPECT_TRUE(leases.stuck());
}

TEST_F(LeasesTest, BlameMayComeLaterThanTheLoss) {
  addTargets(0, 1, 1);
  for (int death = 0; death < deaths_before_aside; ++death) {
    handOut("a");
    const Leases::Suspects suspects = leases.suspectsOf("a", way(0, 1, 0));
    leases.giveBack("a");
    EXPECT_EQ(leases.waiting(), 1u);
    leases.blame(suspects);
  }
  EXPECT_EQ(leases.waiting(), 0u);
  EXPECT_TRUE(leases.stuck());
  leases.finish(way(0, 1, 0));
  EXPECT_TRUE(leases.blame({.named = way(0, 1, 0), .next = {}}).empty())
      << "a finished target blames nobody";
}

TEST_F(LeasesTest, AFatalTargetWithoutHeartbeatIsFoundOnceItIsAlone) {
  addTargets(0, 1, 4);
  int deaths = 0;
  while (leases.aside().empty() && deaths < 100) {
    const Handout job = handOut("a");
    if (targetsOf(job).front() != 1) {
      for (const ResultKey& key : job.targets) leases.finish(key);
      continue;
    }
    die("a", std::nullopt);
    ++deaths;
  }
  EXPECT_THAT(leases.aside(), ElementsAre(way(0, 1, 0)));
  EXPECT_EQ(deaths, losses_before_alone + deaths_before_aside);
}

/// A worker that never received its first job dies on its second job.
TEST_F(LeasesTest, OneLostWorkerCountsAsOneDeath) {
  leases.add(way(0, 1, 0), {.attempts = 9, .suspected = 9, .deaths = deaths_before_aside - 1});
  leases.add(way(0, 2, 1), {.attempts = 9, .suspected = 0, .deaths = deaths_before_aside - 2});
  EXPECT_THAT(targetsOf(handOut("a")), ElementsAre(1));
  EXPECT_THAT(targetsOf(handOut("a")), ElementsAre(2));
  die("a", way(0, 2, 1));
  EXPECT_TRUE(leases.aside().empty());
  EXPECT_THAT(targetsOf(handOut("a")), ElementsAre(1));
  EXPECT_THAT(targetsOf(handOut("a")), ElementsAre(2));
  die("a", way(0, 2, 1));
  EXPECT_THAT(leases.aside(), ElementsAre(way(0, 2, 1)));
}

TEST_F(LeasesTest, AGoodbyeBlamesNoTarget) {
  addTargets(0, 1, 1);
  for (int n = 0; n < 20; ++n) {
    EXPECT_EQ(attemptsOfNext("a"), static_cast<std::uint32_t>(n + 1));
    leases.giveBack("a");
  }
  EXPECT_EQ(leases.waiting(), 1u);
}

TEST_F(LeasesTest, FindsTheTransitionNamedByAHeartbeat) {
  addTargets(4, 9, 1, 2);
  const Handout job = handOut("a");
  EXPECT_THAT(leases.openOf("a", job.job), ElementsAre(way(2, 9, 4)));
  EXPECT_TRUE(leases.openOf("a", job.job + 1).empty());
  EXPECT_TRUE(leases.openOf("b", job.job).empty());
}

TEST_F(LeasesTest, CountsHeldTargetsHoweverALeaseEnds) {
  addTargets(0, 1, 4);
  const Handout job = handOut("a", 1);
  ASSERT_EQ(job.targets.size(), 2u);
  handOut("b", 1);
  handOut("b", 1);
  EXPECT_EQ(leases.leasedTo("a"), 2u);
  EXPECT_EQ(leases.leasedTo("b"), 2u);
  EXPECT_EQ(leases.leasedTo("nobody"), 0u);
  leases.finish(way(0, 1, 0));
  EXPECT_EQ(leases.leasedTo("a"), 1u) << "finished by any worker";
  leases.giveBackLast("b");
  EXPECT_EQ(leases.leasedTo("b"), 1u);
  leases.giveBack("a");
  EXPECT_EQ(leases.leasedTo("a"), 0u);
  EXPECT_EQ(leases.waiting(), 2u);
}

TEST_F(LeasesTest, ReportsIfOnlyChecksAreLeftOrNobodySolves) {
  const auto anybody = [](const ResultKey&) { return true; };
  leases.add(way(0, 1, 0));
  leases.addCheck(way(0, 2, 0));
  EXPECT_FALSE(leases.onlyChecksLeft()) << "another target waits";
  handOut("a");
  ASSERT_TRUE(leases.handOutCheck("b", anybody));
  EXPECT_FALSE(leases.onlyChecksLeft()) << "a worker solves another target";
  leases.finish(way(0, 1, 0));
  EXPECT_TRUE(leases.onlyChecksLeft());
  EXPECT_FALSE(leases.stuck()) << "the check is being solved";
  leases.giveBack("b");
  EXPECT_TRUE(leases.onlyChecksLeft());
  EXPECT_TRUE(leases.stuck());
  ASSERT_TRUE(leases.handOutCheck("a", anybody));
  leases.finish(way(0, 2, 0));
  EXPECT_FALSE(leases.stuck()) << "nothing is left";
}

TEST_F(LeasesTest, HandsOutSpacesOfHigherPriorityFirst) {
  for (const std::uint32_t space : {0u, 1u, 2u}) leases.add(way(space, 1, 0));
  leases.setPriority(1, -1);
  leases.setPriority(2, 5);
  leases.add(way(2, 9, 8));
  std::vector<std::uint32_t> order;
  while (const auto handout = leases.handOut("w", 1)) order.push_back(spaceOf(*handout));
  EXPECT_THAT(order, ElementsAre(2, 2, 0, 1));
  EXPECT_EQ(leases.waiting(), 0u);
}

}  // namespace
}  // namespace palpate
