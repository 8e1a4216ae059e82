#include "scheduler/fleet/launches.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace palpate {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;
using How = Launches::Ended::How;

constexpr int any_number = std::numeric_limits<int>::max();

struct LaunchesTest : testing::Test {
  Launches launches{10s};
  Launches::Time now{1h};
  std::vector<Launches::Ended> ended;
  std::vector<Launches::Running> running;

  void end(const std::string& node, How how = How::failed, std::chrono::seconds age = 1s) {
    const std::string number = std::to_string(100 + ended.size());
    ended.push_back({.id = number,
                     .node = node,
                     .how = how,
                     .words = "exit code 127",
                     .age = age,
                     .when = "2026-11-25T00:00:" + number});
  }
  void fail(int times, const std::string& node) {
    for (int n = 0; n < times; ++n) end(node);
  }
  Launches::Change see() { return launches.see(ended, running, now); }
};

TEST_F(LaunchesTest, AreNotDelayedByAFewOrRepeatedFailures) {
  fail(Launches::most_in_a_row - 1, "a");
  for (int turn = 0; turn < 3; ++turn) EXPECT_FALSE(see().held);
  EXPECT_EQ(launches.mostUnproven(now), any_number);
}

TEST_F(LaunchesTest, AreTriedSinglyAtGrowingIntervalsWhenAllFail) {
  fail(Launches::most_in_a_row, "a");
  EXPECT_TRUE(see().held);
  EXPECT_THAT(launches.failures(), SizeIs(Launches::most_in_a_row));
  for (const std::chrono::seconds pause : {10s, 20s, 40s}) {
    EXPECT_EQ(launches.pause(), pause);
    EXPECT_EQ(launches.mostUnproven(now + pause - 1s), 0);
    now += pause;
    EXPECT_FALSE(see().held) << "nothing new";
    EXPECT_EQ(launches.mostUnproven(now), 1);
    fail(1, "b");
    EXPECT_TRUE(see().held);
  }
}

TEST_F(LaunchesTest, SimultaneousFailuresLengthenTheDelayOnce) {
  fail(16, "a");
  see();
  EXPECT_EQ(launches.pause(), 10s);
}

TEST_F(LaunchesTest, ContinueWhenALaterOneSurvives) {
  fail(Launches::most_in_a_row, "a");
  running = {{"old", "b", 50s}};
  // An old job that still runs does not show that new launches would survive. Node "a" is the only
  // one that fails.
  EXPECT_THAT(see().left_out, ElementsAre("a"));

  Launches all_fail{10s};
  running = {{"old", "a", 50s}};
  EXPECT_TRUE(all_fail.see(ended, running, now).held);
  now += Launches::early + 1s;
  running = {{"trial", "a", Launches::early}};
  all_fail.see(ended, running, now);
  EXPECT_FALSE(all_fail.held());
  EXPECT_EQ(all_fail.mostUnproven(now), any_number);
}

TEST_F(LaunchesTest, ContinueWhenOneEndsWellOrLate) {
  for (const How how : {How::well, How::failed}) {
    fail(Launches::most_in_a_row - 1, "a");
    end("a", how, how == How::failed ? Launches::early : 1s);
    fail(Launches::most_in_a_row - 1, "a");
    see();
    EXPECT_FALSE(launches.held());
  }
  fail(Launches::most_in_a_row - 1, "c");
  end("c", How::from_outside);
  fail(1, "c");
  EXPECT_TRUE(see().held) << "a cancelled job proves nothing";
}

TEST_F(LaunchesTest, ANodeThatFailsJobsWhileOthersWorkIsExcluded) {
  running = {{"1", "good", Launches::early}};
  fail(Launches::most_on_a_node - 1, "bad");
  EXPECT_THAT(see().left_out, IsEmpty());
  fail(14, "bad");
  const Launches::Change change = see();
  EXPECT_THAT(change.left_out, ElementsAre("bad"));
  EXPECT_FALSE(change.held);
  EXPECT_THAT(launches.badNodes(), ElementsAre("bad"));
  fail(20, "bad");  // launches that were queued already
  EXPECT_THAT(see().left_out, IsEmpty());
  EXPECT_EQ(launches.mostUnproven(now), any_number);
}

TEST_F(LaunchesTest, AFailingNodeIsExcludedOnceAnotherIsKnownToWork) {
  running = {{"1", "good", Launches::early - 1s}};
  fail(16, "bad");
  EXPECT_TRUE(see().held) << "by now all nodes may fail";
  running[0].age += 2s;
  now += 2s;
  const Launches::Change change = see();
  EXPECT_THAT(change.left_out, ElementsAre("bad"));
  EXPECT_FALSE(launches.held());
}

TEST_F(LaunchesTest, TheLastNodeIsNeverExcluded) {
  running = {{"1", "b", 100s}};
  fail(3, "a");
  EXPECT_THAT(see().left_out, ElementsAre("a"));
  fail(5, "b");
  const Launches::Change change = see();
  EXPECT_THAT(change.left_out, IsEmpty());
  EXPECT_TRUE(change.held);
}

}  // namespace
}  // namespace palpate
