// Workers that join, leave, fall silent, and die during solves.

#include <spdlog/sinks/ostream_sink.h>

#include <sstream>

#include "tests/scheduler/service/coordinator_fixture.hpp"
#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;
using wire::Message;

using CoordinatorTest = test::CoordinatorFixture;

TEST_F(CoordinatorTest, RefusesWorkersThatCannotGiveTheSameBits) {
  Message other = test::helloOf("a");
  other.mutable_hello()->set_protocol(99);
  EXPECT_THAT(refusalOf(other), testing::HasSubstr("protocol 99"));
  other = test::helloOf("a");
  other.mutable_hello()->set_version("0.0.0");
  EXPECT_THAT(refusalOf(other), testing::HasSubstr("palpate 0.0.0"));
  solveOrigins();
  other = test::helloOf("b");
  other.mutable_hello()->set_kernel_family("avx512");
  world.send("b", other);
  EXPECT_THAT(world.take("b", Message::kRefused).at(0).refused().reason(),
              testing::AllOf(testing::HasSubstr("avx512"), testing::HasSubstr("baseline")));
  EXPECT_EQ(world.coordinator().workers(), 1u);
}

/// 130,500 Hellos in ten seconds once made a log of 140 MB and tables of 159 MB.
TEST_F(CoordinatorTest, EndlessHellosFillNeitherTheLogNorTheTables) {
  std::ostringstream log;
  const auto before = spdlog::default_logger();
  spdlog::set_default_logger(std::make_shared<spdlog::logger>(
      "hello", std::make_shared<spdlog::sinks::ostream_sink_st>(log)));
  const Message goodbye = test::goodbyeOf("\x1b[2J\nsee you");
  for (int i = 0; i < 20000; ++i) {
    const std::string name = std::to_string(i);
    world.send(name, test::helloOf(name));
    if (i % 2 == 0) world.send(name, goodbye);
    if (i % 100 == 0) world.pass(25ms);
  }
  spdlog::set_default_logger(before);
  EXPECT_LT(log.str().size(), 200'000u);
  EXPECT_THAT(log.str(), testing::HasSubstr("log lines about them were omitted"));
  EXPECT_THAT(log.str(), testing::Not(testing::HasSubstr("\x1b")));
  EXPECT_LE(world.coordinator().workers(), WorkerRegistry::most_workers);
  EXPECT_LE(StoredTables(world.directory / "state").servers().size(),
            WorkerRegistry::most_workers + Tables::most_idle_departed);
}

/// Regression: the kernels in the first Hello decided. A worker with the kernels nonsense/42 that
/// left at once kept every honest worker out.
TEST_F(CoordinatorTest, TheFirstResultSendsWorkersWithOtherKernelsAway) {
  Message other = test::helloOf("other");
  other.mutable_hello()->set_kernel_family("nonsense/42");
  world.send("other", other);
  world.request("other", 1);
  EXPECT_EQ(world.takeJobs("other").size(), 1u);
  solveOrigins();
  EXPECT_EQ(world.coordinator().workers(), 1u);
  // The scheduler asks the other worker for a Hello and then explains the refusal.
  EXPECT_EQ(world.take("other", Message::kHeartbeatReply).size(), 1u);
  world.send("other", other);
  EXPECT_EQ(world.take("other", Message::kRefused).size(), 1u);
  for (const wire::Job& job : world.takeJobs("a")) world.deliver("a", job);
  world.request("a", 1);
  world.finish({"a"});
}

TEST_F(CoordinatorTest, AWorkerThatSupportsTheBuildsKernelsIsAskedToUseThem) {
  Message newer = test::helloOf("newer");
  newer.mutable_hello()->set_kernel_family("avx512");
  newer.mutable_hello()->add_runs("baseline");
  world.send("newer", newer);
  EXPECT_EQ(world.take("newer", Message::kWelcome).size(), 1u) << "nothing is decided yet";
  solveOrigins();
  EXPECT_EQ(world.take("newer", Message::kHeartbeatReply).size(), 1u);
  world.send("newer", newer);
  const auto asked = world.take("newer", Message::kUseKernels);
  ASSERT_EQ(asked.size(), 1u);
  EXPECT_EQ(asked[0].use_kernels().kernel_family(), "baseline");
  EXPECT_EQ(world.coordinator().workers(), 1u) << "it does not work before it uses them";
  world.join("newer", 1);
  EXPECT_EQ(world.coordinator().workers(), 2u);
}

struct ChosenKernelsTest : testing::Test {
  static CoordinatorSettings chosen(const char* family) {
    CoordinatorSettings settings = test::BuildWorld::withoutChecks();
    settings.kernel_family = family;
    return settings;
  }
};

TEST_F(ChosenKernelsTest, DecideBeforeTheFirstResult) {
  test::BuildWorld world(chosen("avx2/Haswell"));
  world.send("a", test::helloOf("a"));
  const auto refused = world.take("a", Message::kRefused);
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_THAT(refused[0].refused().reason(),
              testing::AllOf(testing::HasSubstr("uses the avx2/Haswell kernels"),
                             testing::HasSubstr("the worker has only the baseline kernels")));
  EXPECT_EQ(world.coordinator().status(world.now).kernel_family(), "avx2/Haswell");
}

TEST_F(ChosenKernelsTest, MustBeTheKernelsOfTheBuild) {
  test::BuildWorld world(chosen("baseline"));
  world.solveOrigins();
  world.restart();
  test::expectBadInput([&] { world.restartWith(chosen("avx2/Haswell")); },
                       {"began with the baseline kernels", "--kernels asks for avx2/Haswell"});
}

TEST_F(CoordinatorTest, RemembersTheKernelFamilyOfRecordedResults) {
  solveOrigins();
  world.restart();
  Message other = test::helloOf("a");
  other.mutable_hello()->set_kernel_family("avx2");
  EXPECT_THAT(refusalOf(other), testing::HasSubstr("avx2"));
}

TEST_F(CoordinatorTest, ReassignsASilentWorkersTargetAndTakesTheLateAnswer) {
  world.join("a", 2);
  const auto lost = world.takeJobs("a");
  world.pass(59s);
  world.join("b", 2);
  EXPECT_TRUE(world.takeJobs("b").empty());
  world.pass(2s);
  const auto again = world.takeJobs("b");
  ASSERT_EQ(again.size(), 2u);
  // The worker was not dead. The scheduler asks for its Hello, and its late result arrives first.
  world.deliver("a", lost[0]);
  world.join("a", 0);
  world.deliver("a", lost[0]);
  world.pass(25ms);
  EXPECT_EQ(world.take("a", Message::kResultAck).size(), 1u);
  world.deliver("b", again[0]);
  EXPECT_EQ(world.take("b", Message::kResultAck).size(), 1u);
  EXPECT_EQ(world.counter("duplicate_results"), 1);
}

/// If, for example, a container is frozen or a disk stalls, messages of workers wait unread.
TEST_F(CoordinatorTest, ASuspendedSchedulerBlamesNoWorker) {
  world.join("a", 2);
  const auto jobs = world.takeJobs("a");
  for (int n = 0; n < 8; ++n) {
    world.sleep(62s);
    world.settle();
    EXPECT_EQ(world.coordinator().workers(), 1u);
    world.pass(1s);
    world.beat("a", &jobs[0]);
  }
  EXPECT_EQ(world.counter("lost_workers"), 0);
  world.deliver("a", jobs[0]);
  world.pass(25ms);
  EXPECT_EQ(world.take("a", Message::kResultAck).size(), 1u);
}

TEST_F(CoordinatorTest, JudgesSilenceOnlyAfterReadingEverything) {
  world.join("a", 2);
  world.takeJobs("a");
  for (int second = 0; second < 100; ++second) {
    world.now += 1s;
    world.coordinator().advance(world.now, false);
  }
  EXPECT_EQ(world.coordinator().workers(), 1u);
  world.settle();
  EXPECT_EQ(world.coordinator().workers(), 0u);
}

/// A killed process is only noticed when a message is sent to it.
TEST_F(CoordinatorTest, PingsABusyWorkerThatIsSilentForThreeHeartbeats) {
  world.join("a", 2);
  world.join("idle", 0);
  world.inbox.clear();
  world.pass(2900ms);
  EXPECT_TRUE(world.take("a", Message::kHeartbeatReply).empty());
  world.pass(3s);
  EXPECT_GE(world.take("a", Message::kHeartbeatReply).size(), 2u);
  EXPECT_TRUE(world.take("idle", Message::kHeartbeatReply).empty());
  world.coordinator().peerUnreachable("a", world.now);
  world.join("b", 2);
  EXPECT_EQ(world.takeJobs("b").size(), 2u);
}

TEST_F(CoordinatorTest, HeartbeatsKeepALeaseForHours) {
  world.join("a", 2);
  const auto jobs = world.takeJobs("a");
  for (int n = 0; n < 200; ++n) {
    world.pass(50s);
    world.beat("a", &jobs[0]);
  }
  world.join("b", 1);
  EXPECT_TRUE(world.takeJobs("b").empty());
}

TEST_F(CoordinatorTest, TakesBackTargetsThatAnIdleWorkerNeverReceived) {
  world.join("a", 2);
  world.takeJobs("a");
  for (int n = 0; n < 3; ++n) {
    world.pass(15s);
    world.beat("a");
  }
  world.settle();
  const auto jobs = world.takeJobs("a");
  ASSERT_EQ(jobs.size(), 2u);
}

TEST_F(CoordinatorTest, AWorkerReturnsItsWorkWithAGoodbye) {
  world.join("a", 2);
  world.join("b", 2);
  world.takeJobs("a");
  world.send("a", test::goodbyeOf("tired"));
  world.settle();
  EXPECT_EQ(world.takeJobs("b").size(), 2u);
  EXPECT_EQ(world.coordinator().workers(), 1u);
}

TEST_F(CoordinatorTest, AWorkerThatIntroducesItselfAgainHasForgottenItsJobs) {
  world.join("a", 2);
  EXPECT_EQ(world.takeJobs("a").size(), 2u);
  world.join("a", 2);
  const auto jobs = world.takeJobs("a");
  ASSERT_EQ(jobs.size(), 2u);
}

TEST_F(CoordinatorTest, APeerThatChangesItsNameLosesTheFirst) {
  world.join("a", 2);
  EXPECT_EQ(world.takeJobs("a").size(), 2u);
  world.send("a", test::helloOf("another"));
  EXPECT_EQ(world.coordinator().workers(), 1u);
  world.request("a", 2);
  const auto jobs = world.takeJobs("a");
  ASSERT_EQ(jobs.size(), 2u);
}

TEST_F(CoordinatorTest, ASolveIsHungAfterThirtyTimesTheLongestOne) {
  world.join("a", 1);
  EXPECT_EQ(world.takeJobs("a").at(0).hung_after_s(), 3600u) << "nothing is known yet";
  for (const auto& [seconds, limit] : {std::pair(0.25, 120u), {10, 300u}, {1e9, 604800u}}) {
    test::BuildWorld other;
    other.join("a", 1);
    const wire::Job job = other.takeJobs("a").at(0);
    auto [result, payload] = test::solve(other.problem, job.space(), {}, {});
    result.mutable_cost()->set_seconds(seconds);
    other.prove("a", result);
    Message message;
    *message.mutable_result() = result;
    other.send("a", message, payload);
    other.pass(25ms);
    other.request("a", 1);
    EXPECT_EQ(other.takeJobs("a").at(0).hung_after_s(), limit);
    other.restart();
    other.join("a", 1);
    EXPECT_EQ(other.takeJobs("a").at(0).hung_after_s(), limit) << "also after a restart";
  }
}

TEST_F(CoordinatorTest, SilenceAndBrokenConnectionsBlameNoTarget) {
  for (std::uint32_t n = 1; n <= 12; ++n) {
    const std::string peer = fmt::format("w{}", n);
    world.join(peer, 1, n);
    for (const wire::Job& job : world.takeJobs(peer)) world.beat(peer, &job);
    if (n % 2 == 0)
      world.pass(61s);
    else
      world.coordinator().peerUnreachable(peer, world.now);
  }
  EXPECT_EQ(world.counter("lost_workers"), 12);
  world.join("a", 2);
  EXPECT_EQ(world.takeJobs("a").size(), 2u);
  EXPECT_FALSE(world.coordinator().stuck());
}

/// Five processes die on the origin of space 0, which is then set aside.
struct SetAsideTest : CoordinatorTest {
  static bool kills(const wire::Job& job) {
    return job.space() == 0 && fromWire(job.targets(0).point()) == LatticePoint{0, 0, 0};
  }
  void killFive() {
    for (int death = 0; death < deaths_before_aside; ++death) {
      const std::string victim = fmt::format("victim{}", death);
      world.join(victim, 1);
      for (const wire::Job& job : world.takeJobs(victim)) {
        ASSERT_TRUE(kills(job));
        world.beat(victim, &job);
      }
      reportEnd(victim);
    }
  }
  /// The successor of a worker reports that its process ended, and leaves.
  void reportEnd(const std::string& id) {
    Message hello = test::helloOf(id + "-next");
    hello.mutable_hello()->add_ended(id);
    world.send("next", hello);
    world.send("next", test::goodbyeOf());
  }
  /// Completes everything else.
  void finishTheRest() {
    world.join("a", 1);
    for (int turns = 0; !world.coordinator().stuck(); ++turns) {
      ASSERT_LT(turns, 10000);
      for (const wire::Job& job : world.takeJobs("a")) {
        ASSERT_FALSE(kills(job));
        world.deliver("a", job);
        world.request("a", 1);
      }
      world.pass(25ms);
    }
  }
  ContentId undisturbed() {
    test::BuildWorld calm;
    calm.join("a", 1);
    calm.finish({"a"});
    return calm.sealedContent();
  }
};

TEST_F(SetAsideTest, OtherTargetsContinueAndNothingIsSealedWithoutIt) {
  killFive();
  EXPECT_EQ(world.counter("lost_workers"), 5);
  finishTheRest();
  EXPECT_FALSE(world.coordinator().complete());
  EXPECT_EQ(world.coordinator().status(world.now).set_aside(), 1);
  EXPECT_EQ(world.coordinator().plans()[0].points().record(0).tag, Tag::unknown);
  EXPECT_TRUE(world.coordinator().plans()[1].complete());
}

TEST_F(SetAsideTest, ARestartRemembersItAndRetryRepeatsIt) {
  killFive();
  finishTheRest();
  world.restart();
  EXPECT_TRUE(world.coordinator().stuck());
  EXPECT_EQ(retryFailed(), 1u);
  EXPECT_FALSE(world.coordinator().stuck());
  world.join("a", 1);
  world.finish({"a"});
  EXPECT_EQ(world.sealedContent(), undisturbed()) << "no death leaves a trace";
}

TEST_F(SetAsideTest, ALateResultReplacesIt) {
  killFive();
  world.join("victim0", 0);
  world.deliver("victim0", 0, toWire(LatticePoint{}), toWire(LatticePoint{}));
  world.join("a", 1);
  world.finish({"a"});
  EXPECT_EQ(world.sealedContent(), undisturbed());
}

TEST_F(SetAsideTest, AnotherWorkerReportsWhichProcessesEnded) {
  for (int death = 0; death < deaths_before_aside; ++death) {
    const std::string id = fmt::format("remote{}", death);
    world.join(id, 1);
    for (const wire::Job& job : world.takeJobs(id)) world.beat(id, &job);
    // The scheduler notices half of the deaths earlier, by the broken connections.
    if (death % 2 == 0) world.coordinator().peerUnreachable(id, world.now);
    reportEnd(id);
  }
  EXPECT_EQ(world.coordinator().status(world.now).set_aside(), 1);
}

/// The targets that a worker held when its connection broke are not blamed. The death of the worker
/// counts once, however often its successor reports it.
TEST_F(SetAsideTest, AReconnectedWorkersDeathCountsOnceOnItsLastTarget) {
  for (int death = 0; death < deaths_before_aside - 1; ++death) {
    const std::string id = fmt::format("remote{}", death);
    for (int connection = 0; connection < 2; ++connection) {
      world.join(id, 1);
      for (const wire::Job& job : world.takeJobs(id)) world.beat(id, &job);
      world.coordinator().peerUnreachable(id, world.now);
    }
    Message hello = test::helloOf(id + "-next");
    hello.mutable_hello()->add_ended(id);
    world.send("next", hello);
    world.send("next", hello);
    world.send("next", test::goodbyeOf());
  }
  EXPECT_EQ(world.coordinator().status(world.now).set_aside(), 0) << "four deaths are not five";
}

}  // namespace
}  // namespace palpate
