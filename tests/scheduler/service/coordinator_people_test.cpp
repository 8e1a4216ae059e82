// Requests of people: stop, pause, priorities, retry.

#include "tests/scheduler/service/coordinator_fixture.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;
using wire::Message;

using CoordinatorTest = test::CoordinatorFixture;

std::string prioritize(test::BuildWorld& world, const std::string& space, std::int32_t priority) {
  Message order;
  order.mutable_priority_request()->set_space(space);
  order.mutable_priority_request()->set_priority(priority);
  world.send("operator", order);
  const auto replies = world.take("operator", Message::kPriorityReply);
  EXPECT_EQ(replies.size(), 1u);
  return replies.empty() ? "no answer" : replies[0].priority_reply().objection();
}

/// Sends an operator's request.
void setPaused(test::BuildWorld& world, bool paused) {
  Message order;
  order.mutable_pause_request()->set_paused(paused);
  world.send("operator", order);
  const auto replies = world.take("operator", Message::kPauseReply);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].pause_reply().paused(), paused);
}

TEST_F(CoordinatorTest, StopsWithoutHandingOutMoreAndResumesLater) {
  world.join("a", 1);
  const auto jobs = world.takeJobs("a");
  Message stop;
  stop.mutable_stop_request();
  world.send("operator", stop);
  EXPECT_EQ(world.take("operator", Message::kStopReply).size(), 1u);
  ASSERT_EQ(world.take("a", Message::kDrain).size(), 1u);
  world.deliver("a", jobs[0]);
  world.pass(25ms);
  EXPECT_EQ(world.take("a", Message::kResultAck).size(), 1u)
      << "results of running solves are still accepted";
  world.request("a", 1);
  EXPECT_TRUE(world.takeJobs("a").empty());
  world.restart();
  world.join("a", 1);
  world.finish({"a"});
  EXPECT_TRUE(world.coordinator().complete());
}

TEST_F(CoordinatorTest, HandsOutNothingWhilePausedAndKeepsItsWorkers) {
  world.join("a", 2);
  const auto jobs = world.takeJobs("a");
  setPaused(world, true);
  world.deliver("a", jobs[0]);
  world.pass(25ms);
  EXPECT_EQ(world.take("a", Message::kResultAck).size(), 1u)
      << "results of running solves are still accepted";
  world.request("a", 1);
  world.pass(1s);
  EXPECT_TRUE(world.takeJobs("a").empty());
  EXPECT_TRUE(world.take("a", Message::kDrain).empty());
  EXPECT_TRUE(world.coordinator().status(world.now).paused());
  setPaused(world, false);
  world.pass(25ms);
  EXPECT_FALSE(world.takeJobs("a").empty());
}

TEST_F(CoordinatorTest, HandsOutHigherPrioritySpacesFirstEvenAfterARestart) {
  const std::string second = world.problem.active[1].name;
  EXPECT_EQ(prioritize(world, second, 1), "");
  EXPECT_THAT(
      prioritize(world, "nobody", 1),
      testing::AllOf(testing::HasSubstr("no space named nobody"), testing::HasSubstr(second)));
  world.join("a", 1);
  const auto first = world.takeJobs("a");
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first[0].space(), 1u);
  world.restart();
  EXPECT_EQ(world.coordinator().status(world.now).spaces(1).priority(), 1);
  world.join("a", 1);
  EXPECT_EQ(world.takeJobs("a").at(0).space(), 1u);
}

/// A machine with too little memory fails in solves in which other machines succeed.
TEST_F(CoordinatorTest, RetriesFailuresOfACauseAndEndsWithTheSameDataset) {
  test::BuildWorld healthy;
  healthy.join("a", 1);
  healthy.finish({"a"});
  failWithoutMemory();
  solveOrigins();
  world.request("a", 1);
  for (const wire::Job& job : world.takeJobs("a")) world.deliver("a", job);
  world.pass(25ms);
  const auto failed = [&] {
    return world.coordinator().status(world.now).failed_attempts().count("factorization_failed");
  };
  EXPECT_EQ(failed(), 1u);
  EXPECT_EQ(retryFailed("limit_point"), 0u);
  EXPECT_GE(retryFailed("factorization_failed"), 1u);
  EXPECT_EQ(retryFailed("factorization_failed"), 0u) << "once";
  EXPECT_EQ(world.settle(), Next::go_on);
  EXPECT_EQ(world.settle(), Next::anew) << "in the next turn, when it is answered";
  world.solver = test::solve;
  world.restart();
  EXPECT_EQ(failed(), 0u);
  world.join("a", 1);
  world.finish({"a"});
  EXPECT_EQ(world.sealedContent(), healthy.sealedContent());
}

/// Once the build is complete, its failures are part of the dataset that is being sealed.
TEST_F(CoordinatorTest, RetriesNoFailureOnceItIsComplete) {
  failWithoutMemory();
  world.join("a", 1);
  world.finish({"a"});
  EXPECT_EQ(retryFailed("factorization_failed"), 0u);
  EXPECT_EQ(world.settle(), Next::complete);
}

TEST_F(CoordinatorTest, StaysPausedOverARestart) {
  setPaused(world, true);
  world.restart();
  EXPECT_TRUE(world.coordinator().paused());
  world.join("a", 1);
  world.pass(1s);
  EXPECT_TRUE(world.takeJobs("a").empty());
  setPaused(world, false);
  world.finish({"a"});
  world.restart();
  EXPECT_FALSE(world.coordinator().paused());
}

}  // namespace
}  // namespace palpate
