#include "scheduler/service/chronicle.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scheduler/events/event_reader.hpp"
#include "tests/scheduler/build_world.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

/// A build that logs its events.
struct ChronicleTest : testing::Test {
  test::TemporaryDirectory directory;
  EventLog log{directory.path()};
  test::BuildWorld world{withEvents(log)};

  static CoordinatorSettings withEvents(EventLog& log) {
    CoordinatorSettings settings = test::BuildWorld::withoutChecks();
    settings.events = &log;
    return settings;
  }
  std::vector<std::string> events(const std::string& word) {
    log.flush();
    return lastEvents(directory.path(), {word}, 10000);
  }
};

TEST_F(ChronicleTest, LogsHowWorkersJoinAndLeave) {
  world.join("a", 2);
  world.join("b", 2, 7);
  world.pass(25ms);
  world.send("a", test::goodbyeOf("told\nto"));
  wire::Message successor = test::helloOf("e");
  successor.mutable_hello()->add_ended("b");
  world.send("e", successor);
  world.join("c", 2);
  world.coordinator().peerUnreachable("c", world.now);
  world.send("d", [] {
    wire::Message hello = test::helloOf("d");
    hello.mutable_hello()->set_version("other");
    return hello;
  }());
  EXPECT_THAT(events("worker_joined"), SizeIs(4));
  EXPECT_THAT(events("worker_left"), ElementsAre(AllOf(HasSubstr(R"("worker":"61","host":"here")"),
                                                       HasSubstr("told?to"))));
  EXPECT_THAT(events("worker_ended"), ElementsAre(HasSubstr(R"("pid":7)")));
  EXPECT_THAT(events("worker_lost"), ElementsAre(HasSubstr(R"("how":"unreachable")")));
  EXPECT_THAT(events("worker_refused"), ElementsAre(HasSubstr("other")));
}

TEST_F(ChronicleTest, LogsFailedAttemptsAsStatusCountsThem) {
  world.join("a", 8);
  world.finish({"a"});
  std::int64_t failed = 0;
  const wire::Status status = world.coordinator().status(world.now);
  for (const auto& [cause, count] : status.failed_attempts()) {
    failed += count;
    EXPECT_THAT(events("failed_attempt"), Contains(HasSubstr("\"cause\":\"" + cause + "\"")));
  }
  ASSERT_GT(failed, 0) << "some transitions of the table fail";
  EXPECT_THAT(events("failed_attempt"), SizeIs(failed));
  EXPECT_THAT(events("failed_attempt"),
              Each(AllOf(HasSubstr(R"("space":")"), HasSubstr(R"("point":[)"),
                         HasSubstr(R"("parent":[)"), HasSubstr(R"("worker":"61")"))));
  EXPECT_THAT(events("stage"), Contains(HasSubstr(R"("stage":"complete")")).Times(2));
  EXPECT_THAT(events("completed"), SizeIs(1));
}

TEST_F(ChronicleTest, ARestartDoesNotLogTheStagesAgain) {
  world.join("a", 8);
  world.finish({"a"});
  const std::size_t before = events("stage").size();
  world.restart();
  EXPECT_EQ(events("stage").size(), before);
}

TEST_F(ChronicleTest, LogsPausesAndRetries) {
  world.coordinator().pause(true);
  world.coordinator().pause(false);
  wire::Message retry;
  retry.mutable_retry_request();
  world.send("operator", retry);
  EXPECT_THAT(events("paused"), SizeIs(1));
  EXPECT_THAT(events("resumed"), SizeIs(1));
  EXPECT_THAT(events("retried"), ElementsAre(HasSubstr(R"("transitions":0)")));
  for (const std::string& space : {world.problem.scene.active[1].name, std::string("nobody")}) {
    wire::Message first;
    first.mutable_priority_request()->set_space(space);
    first.mutable_priority_request()->set_priority(2);
    world.send("operator", first);
  }
  EXPECT_THAT(events("priority"), ElementsAre(HasSubstr(R"("priority":2)")));
}

TEST_F(ChronicleTest, AFloodOfEventsIsCutAndCounted) {
  for (int n = 0; n < 3000; ++n) world.send("x", test::helloOf("x" + std::to_string(n)));
  EXPECT_THAT(events("worker_joined"), SizeIs(LineBudget::burst));
  world.pass(5s);
  world.send("y", test::helloOf("y"));
  EXPECT_THAT(events("left_out"), ElementsAre(HasSubstr(R"("events":2000)")));
  EXPECT_THAT(events("worker_joined"), SizeIs(LineBudget::burst + 1));
}

TEST(Chronicle, WithoutALogNothingHappens) {
  const test::TemporaryDirectory nowhere;
  test::BuildWorld world;
  world.join("a", 2);
  world.coordinator().pause(true);
  world.settle();
  EXPECT_THAT(eventFiles(world.directory / "state"), IsEmpty());
}

}  // namespace
}  // namespace palpate
