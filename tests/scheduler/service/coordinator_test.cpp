#include "scheduler/service/coordinator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>

#include <fstream>
#include <random>
#include <sstream>

#include "tests/scheduler/build_world.hpp"
#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;
using wire::Message;

struct CoordinatorTest : testing::Test {
  test::BuildWorld world;

  std::string refusalOf(const Message& hello) {
    world.send("a", hello);
    const auto refused = world.take("a", Message::kRefused);
    return refused.empty() ? "" : refused[0].refused().reason();
  }
  /// Solves both origins.
  void solveOrigins() {
    world.join("a", 2);
    for (const wire::Job& job : world.takeJobs("a")) world.deliver("a", job);
    world.pass(25ms);
    world.take("a", Message::kResultAck);
  }
  Message originResult(const std::function<void(wire::Result&)>& change = {}) {
    Message message;
    *message.mutable_result() = test::solve(world.problem, 0, {0, 0, 0}, {0, 0, 0}).first;
    world.prove("a", *message.mutable_result());
    if (change) change(*message.mutable_result());
    return message;
  }
  std::string originFields() { return test::solve(world.problem, 0, {0, 0, 0}, {0, 0, 0}).second; }
  std::uint32_t retryFailed(const char* cause) {
    Message order;
    order.mutable_retry_request()->set_cause(cause);
    world.send("operator", order);
    return world.take("operator", Message::kRetryReply).at(0).retry_reply().transitions();
  }
};

TEST_F(CoordinatorTest, WelcomesAWorkerAndSendsItTheProblem) {
  world.send("a", test::helloOf("a"));
  const auto welcome = world.take("a", Message::kWelcome);
  ASSERT_EQ(welcome.size(), 1u);
  EXPECT_EQ(welcome[0].welcome().build(), problemId(world.problem).bytes());
  EXPECT_EQ(welcome[0].welcome().incarnation().size(), 16u);
  Message ask;
  ask.mutable_problem_request();
  world.send("a", ask);
  ASSERT_EQ(world.inbox["a"].size(), 1u);
  EXPECT_EQ(*world.inbox["a"][0].payload, encodeProblem(world.problem));
}

TEST_F(CoordinatorTest, HandsOutTheOriginOfEverySpaceFirstFromTheRestState) {
  world.join("a", 3);
  const auto jobs = world.takeJobs("a");
  ASSERT_EQ(jobs.size(), 2u);
  for (std::uint32_t space : {0u, 1u}) {
    EXPECT_EQ(jobs[space].space(), space);
    EXPECT_EQ(jobs[space].start_id(), "");
    EXPECT_EQ(fromWire(jobs[space].targets(0).point()), (LatticePoint{0, 0, 0}));
    EXPECT_EQ(jobs[space].targets(0).attempt(), 1u);
  }
}

TEST_F(CoordinatorTest, HandsOutNothingWithoutCredit) {
  world.join("a", 0);
  EXPECT_TRUE(world.takeJobs("a").empty());
  world.request("a", 1);
  EXPECT_EQ(world.takeJobs("a").size(), 1u);
}

TEST_F(CoordinatorTest, NamesTheStartOfLaterJobsAndServesItsFields) {
  solveOrigins();
  world.request("a", 1);
  const auto jobs = world.takeJobs("a");
  ASSERT_EQ(jobs.size(), 1u);
  EXPECT_EQ(jobs[0].start_id(), ContentId::of(originFields()).bytes());
  Message ask;
  ask.mutable_fields_request()->set_id(jobs[0].start_id());
  ask.mutable_fields_request()->set_space(jobs[0].space());
  *ask.mutable_fields_request()->mutable_point() = jobs[0].start();
  world.inbox["a"].clear();
  world.send("a", ask);
  ASSERT_EQ(world.inbox["a"].size(), 1u);
  EXPECT_EQ(ContentId::of(*world.inbox["a"][0].payload).bytes(), jobs[0].start_id());
  ask.mutable_fields_request()->set_id(std::string(32, 'x'));
  world.send("a", ask);
  EXPECT_TRUE(world.inbox["a"][1].message.fields_reply().unknown());
}

/// Each has a copy of its own in memory until its peer reads it.
TEST_F(CoordinatorTest, AnswersNoStartsWhileTooManyLieUnread) {
  CoordinatorSettings settings = test::BuildWorld::withoutChecks();
  settings.unread_starts = 2 * originFields().size();
  test::BuildWorld narrow(settings);
  narrow.join("a", 2);
  for (const wire::Job& job : narrow.takeJobs("a")) narrow.deliver("a", job);
  narrow.pass(25ms);
  narrow.request("a", 1);
  const wire::Job job = narrow.takeJobs("a").at(0);
  Message ask;
  ask.mutable_fields_request()->set_id(job.start_id());
  ask.mutable_fields_request()->set_space(job.space());
  *ask.mutable_fields_request()->mutable_point() = job.start();
  for (int n = 0; n < 10; ++n) narrow.send("a", ask);
  EXPECT_EQ(narrow.take("a", Message::kFieldsReply).size(), 3u);
  EXPECT_EQ(narrow.counter("unread_answers"), 7);
  narrow.send("a", ask);
  EXPECT_EQ(narrow.take("a", Message::kFieldsReply).size(), 1u) << "the others were read";
}

TEST_F(CoordinatorTest, AcknowledgesOnlyWhatIsOnDisk) {
  world.join("a", 2);
  const auto jobs = world.takeJobs("a");
  world.deliver("a", jobs[0]);
  EXPECT_TRUE(world.take("a", Message::kResultAck).empty());
  world.pass(10ms);
  EXPECT_TRUE(world.take("a", Message::kResultAck).empty()) << "the group waits for others";
  world.pass(10ms);
  EXPECT_EQ(world.take("a", Message::kResultAck).size(), 1u);
  world.restart();
  EXPECT_EQ(world.coordinator().found(), 1u);
}

TEST_F(CoordinatorTest, CommitsAtOnceWhileAWorkerWaitsForWork) {
  world.join("a", 3);
  const auto jobs = world.takeJobs("a");
  world.deliver("a", jobs[0]);
  world.settle();
  EXPECT_EQ(world.take("a", Message::kResultAck).size(), 1u);
  EXPECT_EQ(world.takeJobs("a").size(), 1u);
}

TEST_F(CoordinatorTest, FinishesTheBuildAndTellsTheWorkersToLeave) {
  world.join("a", 2);
  world.finish({"a"});
  EXPECT_TRUE(world.take("a", Message::kDrain).empty()) << "they may be needed to mend damage";
  world.coordinator().dismiss();
  world.settle();
  const auto drains = world.take("a", Message::kDrain);
  ASSERT_FALSE(drains.empty());
  EXPECT_TRUE(drains.back().drain().finished());
  EXPECT_EQ(world.coordinator().status(world.now).state(), "complete");
}

TEST_F(CoordinatorTest, TheDatasetDoesNotDependOnWorkersLossesOrRestarts) {
  world.join("a", 1);
  world.finish({"a"});
  const ContentId undisturbed = world.sealedContent();

  for (unsigned seed = 1; seed <= 6; ++seed) {
    test::BuildWorld wild;
    std::mt19937 random(seed);
    std::vector<std::pair<std::string, wire::Job>> work;
    int born = 0, turns = 0;
    while (!wild.coordinator().complete()) {
      ASSERT_LT(++turns, 20000);
      if (wild.coordinator().workers() < 3) {
        ++born;
        wild.join(fmt::format("w{}", born), 2, static_cast<std::uint32_t>(born));
      }
      for (auto& [peer, messages] : wild.inbox)
        for (const wire::Job& job : wild.takeJobs(peer)) work.emplace_back(peer, job);
      if (!work.empty()) {
        std::swap(work[random() % work.size()], work.back());
        auto& [peer, job] = work.back();
        const int target = static_cast<int>(random() % static_cast<unsigned>(job.targets_size()));
        wild.deliver(peer, job.space(), job.targets(target).point(), job.start());
        job.mutable_targets()->DeleteSubrange(target, 1);
        if (job.targets().empty()) {
          wild.request(peer, 1);
          work.pop_back();
        }
      }
      if (random() % 25 == 0 && !work.empty()) {
        const std::string victim = work.front().first;
        std::erase_if(work, [&](const auto& entry) { return entry.first == victim; });
        wild.coordinator().peerUnreachable(victim, wild.now);
      }
      if (random() % 60 == 0) {
        work.clear();
        wild.restart();
      }
      wild.pass(std::chrono::milliseconds(random() % 15));
    }
    EXPECT_EQ(wild.sealedContent(), undisturbed) << "seed " << seed;
    EXPECT_EQ(wild.counter("divergent_results"), 0);
  }
}

TEST_F(CoordinatorTest, RefusesWorkersThatWouldNotGiveTheSameBits) {
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
TEST_F(CoordinatorTest, WhoSaysHelloForEverFillsNeitherTheLogNorTheTables) {
  std::ostringstream log;
  const auto before = spdlog::default_logger();
  spdlog::set_default_logger(std::make_shared<spdlog::logger>(
      "hello", std::make_shared<spdlog::sinks::ostream_sink_st>(log)));
  Message goodbye;
  goodbye.mutable_goodbye()->set_reason("\x1b[2J\nsee you");
  for (int i = 0; i < 20000; ++i) {
    const std::string name = std::to_string(i);
    world.send(name, test::helloOf(name));
    if (i % 2 == 0) world.send(name, goodbye);
    if (i % 100 == 0) world.pass(25ms);
  }
  spdlog::set_default_logger(before);
  EXPECT_LT(log.str().size(), 200'000u);
  EXPECT_THAT(log.str(), testing::HasSubstr("lines about them were left out"));
  EXPECT_THAT(log.str(), testing::Not(testing::HasSubstr("\x1b")));
  EXPECT_LE(world.coordinator().workers(), WorkerRegistry::most_workers);
  EXPECT_LE(StoredTables(world.directory / "state").servers().size(),
            WorkerRegistry::most_workers + Tables::most_idle_departed);
}

/// The first Hello once decided: one from nonsense/42 that left at once kept every honest worker
/// out.
TEST_F(CoordinatorTest, TheFirstResultSendsWorkersWithOtherKernelsAway) {
  Message other = test::helloOf("other");
  other.mutable_hello()->set_kernel_family("nonsense/42");
  world.send("other", other);
  world.request("other", 1);
  EXPECT_EQ(world.takeJobs("other").size(), 1u);
  solveOrigins();
  EXPECT_EQ(world.coordinator().workers(), 1u);
  // It is asked who it is, and told why it may not stay.
  EXPECT_EQ(world.take("other", Message::kHeartbeatReply).size(), 1u);
  world.send("other", other);
  EXPECT_EQ(world.take("other", Message::kRefused).size(), 1u);
  for (const wire::Job& job : world.takeJobs("a")) world.deliver("a", job);
  world.request("a", 1);
  world.finish({"a"});
}

TEST_F(CoordinatorTest, AWorkerThatHasTheKernelsOfTheBuildTooIsAskedToTakeThem) {
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
  EXPECT_EQ(world.coordinator().workers(), 1u) << "before it has taken them it does not work";
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

TEST_F(ChosenKernelsTest, DecideBeforeAnybodySolvedAnything) {
  test::BuildWorld world(chosen("avx2/Haswell"));
  world.send("a", test::helloOf("a"));
  const auto refused = world.take("a", Message::kRefused);
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_THAT(refused[0].refused().reason(),
              testing::AllOf(testing::HasSubstr("with the avx2/Haswell kernels"),
                             testing::HasSubstr("the worker has baseline and no others")));
  EXPECT_EQ(world.coordinator().status(world.now).kernel_family(), "avx2/Haswell");
}

TEST_F(ChosenKernelsTest, MustBeThoseThatTheBuildWasBegunWith) {
  test::BuildWorld world(chosen("baseline"));
  world.join("a", 2);
  for (const wire::Job& job : world.takeJobs("a")) world.deliver("a", job);
  world.pass(std::chrono::milliseconds(25));
  world.restart();
  test::expectBadInput([&] { world.restartWith(chosen("avx2/Haswell")); },
                       {"begun with the baseline kernels", "--kernels asks for avx2/Haswell"});
}

TEST_F(CoordinatorTest, RemembersTheKernelFamilyOfRecordedResults) {
  solveOrigins();
  world.restart();
  Message other = test::helloOf("a");
  other.mutable_hello()->set_kernel_family("avx2");
  EXPECT_THAT(refusalOf(other), testing::HasSubstr("avx2"));
}

TEST_F(CoordinatorTest, AsksAWorkerOfAnEarlierRunToIntroduceItselfAndTakesItsResultAgain) {
  world.join("a", 1);
  const auto jobs = world.takeJobs("a");
  world.restart();
  world.deliver("a", jobs[0]);
  const auto replies = world.take("a", Message::kHeartbeatReply);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].heartbeat_reply().incarnation(), "");
  world.join("a", 1);
  world.deliver("a", jobs[0]);
  world.pass(25ms);
  EXPECT_EQ(world.take("a", Message::kResultAck).size(), 1u);
}

TEST_F(CoordinatorTest, AcknowledgesADuplicateAndKeepsOneRecord) {
  solveOrigins();
  world.send("a", originResult([](wire::Result& r) { r.mutable_cost()->set_seconds(99); }),
             originFields());
  EXPECT_EQ(world.take("a", Message::kResultAck).size(), 1u);
  EXPECT_EQ(world.counter("duplicate_results"), 1);
  EXPECT_EQ(world.counter("divergent_results"), 0) << "other seconds are no divergence";
  world.restart();
  EXPECT_EQ(world.coordinator().found(), 2u);
}

TEST_F(CoordinatorTest, CountsADuplicateWithOtherBitsAndKeepsTheFirst) {
  world.join("a", 2);
  world.coordinator().peerUnreachable("a", world.now);
  world.join("b", 2);
  for (const wire::Job& job : world.takeJobs("b")) world.deliver("b", job);
  world.pass(25ms);
  world.join("a", 0);
  world.send("a",
             originResult([](wire::Result& r) { r.mutable_equilibrium()->set_residual(1e-300); }),
             originFields());
  EXPECT_EQ(world.take("a", Message::kResultAck).size(), 1u);
  EXPECT_EQ(world.coordinator().disputedCount(), 1u);
  EXPECT_EQ(world.counter("divergent_results"), 1);
}

TEST_F(CoordinatorTest, TellsAWorkerThatNobodyAsksForItsResult) {
  world.join("a", 2);
  world.deliver("a", 0, toWire(LatticePoint{1, 0, 0}), toWire(LatticePoint{}));
  const auto acks = world.take("a", Message::kResultAck);
  ASSERT_EQ(acks.size(), 1u);
  EXPECT_TRUE(acks.front().result_ack().unwanted());
  EXPECT_EQ(world.counter("unwanted_results"), 1);
  world.restart();
  EXPECT_EQ(world.coordinator().found(), 0u) << "it is not recorded";
}

TEST_F(CoordinatorTest, ARequestAfreshTakesThePlaceOfEarlierOnes) {
  world.join("a", 1);
  EXPECT_EQ(world.takeJobs("a").size(), 1u);
  for (int times = 0; times < 3; ++times) {
    Message message;
    message.mutable_request()->set_credit(2);
    message.mutable_request()->set_afresh(true);
    world.send("a", message);
  }
  EXPECT_EQ(world.coordinator().status(world.now).workers(0).results(), 0);
  world.deliver("a", 0, toWire(LatticePoint{}), toWire(LatticePoint{}));
  world.deliver("a", 1, toWire(LatticePoint{}), toWire(LatticePoint{}));
  world.pass(100ms);
  EXPECT_LE(world.takeJobs("a").size(), 2u) << "credit does not add up";
}

TEST_F(CoordinatorTest, DropsResultsThatMakeNoSense) {
  world.join("a", 2);
  const std::string fields = originFields();
  std::string not_finite = fields;
  not_finite.replace(0, 4, std::string("\0\0\xc0\x7f", 4));
  const std::vector<std::pair<std::function<void(wire::Result&)>, std::string>> bad = {
      {[](wire::Result& r) { r.set_build("another"); }, fields},
      {[](wire::Result& r) { r.set_space(2); }, fields},
      {[](wire::Result& r) { r.mutable_target()->set_i(1000000); }, fields},
      {[](wire::Result& r) { r.set_kernel_family("avx2"); }, fields},
      {[](wire::Result& r) { r.mutable_equilibrium()->set_force("short"); }, fields},
      {[](wire::Result& r) { r.clear_outcome(); }, fields},
      {[](wire::Result& r) { r.mutable_failure()->set_cause(200); }, fields},
      {[](wire::Result& r) {
         r.mutable_failure()->set_cause(static_cast<std::uint32_t>(Cause::unreachable));
       },
       ""},
      {[](wire::Result& r) {
         r.mutable_failure()->set_cause(1), r.mutable_failure()->set_step_reached(7);
       },
       ""},
      {[](wire::Result& r) { r.set_fields_id(std::string(32, 'x')); }, fields},
      {[](wire::Result&) {}, fields.substr(1)},
      {[&](wire::Result& r) { r.set_fields_id(std::string(ContentId::of(not_finite).bytes())); },
       not_finite},
      {[&](wire::Result& r) {
         r.set_fields_id(std::string(ContentId::of(fields.substr(4)).bytes()));
         r.set_payload_bytes(r.payload_bytes() - 4);
       },
       fields.substr(4)},
  };
  for (const auto& [change, payload] : bad) world.send("a", originResult(change), payload);
  world.pass(100ms);
  EXPECT_EQ(world.counter("bad_messages"), static_cast<std::int64_t>(bad.size()));
  EXPECT_TRUE(world.take("a", Message::kResultAck).empty());
  world.send("a", originResult(), fields);
  world.pass(25ms);
  EXPECT_EQ(world.take("a", Message::kResultAck).size(), 1u) << "the right one is still welcome";
}

/// The bound of known causes once stood before limit_point: such results were dropped, never
/// acknowledged, and sent again for ever.
TEST_F(CoordinatorTest, RecordsAndAcknowledgesAResultThatEndedAtALimitPoint) {
  world.join("a", 2);
  Outcome turned_back;
  turned_back.failure.cause = Cause::limit_point;
  turned_back.failure.step_reached = 0.4;
  world.send("a", originResult([&](wire::Result& r) {
               r.clear_fields_id();
               toWire(turned_back, "", r);
               r.clear_payload_bytes();
             }));
  world.pass(25ms);
  EXPECT_EQ(world.take("a", Message::kResultAck).size(), 1u);
  EXPECT_EQ(world.counter("bad_messages"), 0);
  EXPECT_EQ(world.coordinator().plans()[0].point(0).cause, Cause::limit_point);
}

TEST_F(CoordinatorTest, CountsMessagesThatAreNotForIt) {
  world.send("stranger", Message());
  world.join("a", 0);
  world.send("a", Message());
  Message wrong_way;
  wrong_way.mutable_drain();
  world.send("a", wrong_way);
  EXPECT_EQ(world.counter("bad_messages"), 3);
}

TEST_F(CoordinatorTest, GivesASilentWorkersTargetToAnotherAndTakesTheLateAnswer) {
  world.join("a", 2);
  const auto lost = world.takeJobs("a");
  world.pass(59s);
  world.join("b", 2);
  EXPECT_TRUE(world.takeJobs("b").empty());
  world.pass(2s);
  const auto again = world.takeJobs("b");
  ASSERT_EQ(again.size(), 2u);
  EXPECT_EQ(again[0].targets(0).attempt(), 2u);
  // It was not dead: it is asked for its name, and its answer is the first.
  world.deliver("a", lost[0]);
  world.join("a", 0);
  world.deliver("a", lost[0]);
  world.pass(25ms);
  EXPECT_EQ(world.take("a", Message::kResultAck).size(), 1u);
  world.deliver("b", again[0]);
  EXPECT_EQ(world.take("b", Message::kResultAck).size(), 1u);
  EXPECT_EQ(world.counter("duplicate_results"), 1);
}

/// A frozen container, a stalled disk: what the workers said meanwhile lies unread.
TEST_F(CoordinatorTest, ASchedulerThatWasStoppedBlamesNobody) {
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

TEST_F(CoordinatorTest, JudgesNoSilenceBeforeEverythingIsRead) {
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

/// A killed process shows only when something is sent to it.
TEST_F(CoordinatorTest, SendsSomethingToABusyWorkerThatIsSilentForThreeHeartbeats) {
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

TEST_F(CoordinatorTest, TakesBackWhatAnIdleWorkerNeverGot) {
  world.join("a", 2);
  world.takeJobs("a");
  for (int n = 0; n < 3; ++n) {
    world.pass(15s);
    world.beat("a");
  }
  world.settle();
  const auto jobs = world.takeJobs("a");
  ASSERT_EQ(jobs.size(), 2u);
  EXPECT_EQ(jobs[0].targets(0).attempt(), 2u);
}

TEST_F(CoordinatorTest, AWorkerThatSaysGoodbyeHandsItsWorkBack) {
  world.join("a", 2);
  world.join("b", 2);
  world.takeJobs("a");
  Message goodbye;
  goodbye.mutable_goodbye()->set_reason("tired");
  world.send("a", goodbye);
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
  EXPECT_EQ(jobs[0].targets(0).attempt(), 2u);
}

TEST_F(CoordinatorTest, APeerThatTakesAnotherNameGivesUpTheFirst) {
  world.join("a", 2);
  EXPECT_EQ(world.takeJobs("a").size(), 2u);
  world.send("a", test::helloOf("another"));
  EXPECT_EQ(world.coordinator().workers(), 1u);
  world.request("a", 2);
  const auto jobs = world.takeJobs("a");
  ASSERT_EQ(jobs.size(), 2u);
  EXPECT_EQ(jobs[0].targets(0).attempt(), 2u);
}

TEST_F(CoordinatorTest, SharesWhatIsReadyAmongTheWorkersThatHoldLeast) {
  solveOrigins();
  world.join("b", 1);
  world.join("c", 1);
  world.request("a", 1);
  for (const char* peer : {"a", "b", "c"}) EXPECT_EQ(world.takeJobs(peer).size(), 1u) << peer;
}

TEST_F(CoordinatorTest, ASolveIsHungThirtyTimesTheLongestOneLater) {
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

TEST_F(CoordinatorTest, SilenceAndBrokenConnectionsBlameNothing) {
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

/// Five processes end on the origin of space 0, after which it is set aside.
struct SetAsideTest : CoordinatorTest {
  static bool kills(const wire::Job& job) {
    return job.space() == 0 && fromWire(job.targets(0).point()) == LatticePoint{0, 0, 0};
  }
  void killFive() {
    for (int death = 0; death < deaths_before_aside; ++death) {
      world.join("victim", 1, 1000);
      for (const wire::Job& job : world.takeJobs("victim")) {
        ASSERT_TRUE(kills(job));
        world.beat("victim", &job);
      }
      world.coordinator().workerProcessEnded(1000, world.now);
    }
  }
  /// All but that.
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

TEST_F(SetAsideTest, TheRestGoesOnAndNothingIsSealedWithoutIt) {
  killFive();
  EXPECT_EQ(world.counter("lost_workers"), 5);
  finishTheRest();
  EXPECT_FALSE(world.coordinator().complete());
  EXPECT_EQ(world.coordinator().status(world.now).set_aside(), 1);
  EXPECT_EQ(world.coordinator().plans()[0].point(0).tag, Tag::unknown);
  EXPECT_TRUE(world.coordinator().plans()[1].complete());
}

TEST_F(SetAsideTest, ARestartRemembersAndRetryTriesAgain) {
  killFive();
  finishTheRest();
  world.restart();
  EXPECT_TRUE(world.coordinator().stuck());
  Message retry;
  retry.mutable_retry_request();
  world.send("operator", retry);
  const auto replies = world.take("operator", Message::kRetryReply);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].retry_reply().transitions(), 1u);
  EXPECT_FALSE(world.coordinator().stuck());
  world.join("a", 1);
  world.finish({"a"});
  EXPECT_EQ(world.sealedContent(), undisturbed()) << "no death leaves a trace";
}

TEST_F(SetAsideTest, ALateResultReplacesIt) {
  killFive();
  world.join("victim", 0);
  world.deliver("victim", 0, toWire(LatticePoint{}), toWire(LatticePoint{}));
  world.join("a", 1);
  world.finish({"a"});
  EXPECT_EQ(world.sealedContent(), undisturbed());
}

TEST_F(SetAsideTest, AnotherWorkerTellsWhichProcessesEnded) {
  for (int death = 0; death < deaths_before_aside; ++death) {
    const std::string id = fmt::format("remote{}", death);
    world.join(id, 1);
    for (const wire::Job& job : world.takeJobs(id)) world.beat(id, &job);
    // Half of them are noticed before, by their broken connections.
    if (death % 2 == 0) world.coordinator().peerUnreachable(id, world.now);
    Message hello = test::helloOf(id + "-next");
    hello.mutable_hello()->add_ended(id);
    world.send("next", hello);
    Message goodbye;
    goodbye.mutable_goodbye();
    world.send("next", goodbye);
  }
  EXPECT_EQ(world.coordinator().status(world.now).set_aside(), 1);
}

/// What it had when its connection broke is none of its end, and its end counts once, however often
/// its successor tells of it.
TEST_F(SetAsideTest, AWorkerThatCameBackEndsOnceAndOnWhatItHadLast) {
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
    Message goodbye;
    goodbye.mutable_goodbye();
    world.send("next", goodbye);
  }
  EXPECT_EQ(world.coordinator().status(world.now).set_aside(), 0) << "four are not five";
}

TEST_F(CoordinatorTest, StopsWithoutHandingOutMoreAndGoesOnLater) {
  world.join("a", 1);
  const auto jobs = world.takeJobs("a");
  Message stop;
  stop.mutable_stop_request();
  world.send("operator", stop);
  EXPECT_EQ(world.take("operator", Message::kStopReply).size(), 1u);
  ASSERT_EQ(world.take("a", Message::kDrain).size(), 1u);
  world.deliver("a", jobs[0]);
  world.pass(25ms);
  EXPECT_EQ(world.take("a", Message::kResultAck).size(), 1u) << "what is in work is still taken";
  world.request("a", 1);
  EXPECT_TRUE(world.takeJobs("a").empty());
  world.restart();
  world.join("a", 1);
  world.finish({"a"});
  EXPECT_TRUE(world.coordinator().complete());
}

/// As an operator asks it.
void setPaused(test::BuildWorld& world, bool paused) {
  Message order;
  order.mutable_pause_request()->set_paused(paused);
  world.send("operator", order);
  const auto replies = world.take("operator", Message::kPauseReply);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].pause_reply().paused(), paused);
}

TEST_F(CoordinatorTest, HandsOutNothingWhileItIsPausedAndKeepsItsWorkers) {
  world.join("a", 2);
  const auto jobs = world.takeJobs("a");
  setPaused(world, true);
  world.deliver("a", jobs[0]);
  world.pass(25ms);
  EXPECT_EQ(world.take("a", Message::kResultAck).size(), 1u) << "what is in work is still taken";
  world.request("a", 1);
  world.pass(1s);
  EXPECT_TRUE(world.takeJobs("a").empty());
  EXPECT_TRUE(world.take("a", Message::kDrain).empty());
  EXPECT_TRUE(world.coordinator().status(world.now).paused());
  setPaused(world, false);
  world.pass(25ms);
  EXPECT_FALSE(world.takeJobs("a").empty());
}

std::string prioritize(test::BuildWorld& world, const std::string& space, std::int32_t priority) {
  Message order;
  order.mutable_priority_request()->set_space(space);
  order.mutable_priority_request()->set_priority(priority);
  world.send("operator", order);
  const auto replies = world.take("operator", Message::kPriorityReply);
  EXPECT_EQ(replies.size(), 1u);
  return replies.empty() ? "no answer" : replies[0].priority_reply().objection();
}

TEST_F(CoordinatorTest, HandsOutASpaceOfHigherPriorityFirstAndStillAfterARestart) {
  const std::string second = world.problem.active[1].name;
  EXPECT_EQ(prioritize(world, second, 1), "");
  EXPECT_THAT(
      prioritize(world, "nobody", 1),
      testing::AllOf(testing::HasSubstr("no space is called nobody"), testing::HasSubstr(second)));
  world.join("a", 1);
  const auto first = world.takeJobs("a");
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first[0].space(), 1u);
  world.restart();
  EXPECT_EQ(world.coordinator().status(world.now).spaces(1).priority(), 1);
  world.join("a", 1);
  EXPECT_EQ(world.takeJobs("a").at(0).space(), 1u);
}

/// A machine without memory fails where others do not.
TEST_F(CoordinatorTest, TriesAgainWhatFailedWithACauseAndEndsWithTheSameDataset) {
  test::BuildWorld healthy;
  healthy.join("a", 1);
  healthy.finish({"a"});
  bool has_memory = false;
  world.solver = [&](const Problem& problem, std::uint32_t space, const LatticePoint& target,
                     const LatticePoint& parent) {
    if (has_memory || target == LatticePoint{}) return test::solve(problem, space, target, parent);
    Outcome outcome;
    outcome.failure.cause = Cause::factorization_failed;
    return test::resultOf(problemId(problem), space, target, parent, outcome);
  };
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
  world.settle();
  EXPECT_THROW(world.settle(), FailuresRetried) << "in the next turn, when it is answered";
  has_memory = true;
  world.restart();
  EXPECT_EQ(failed(), 0u);
  world.join("a", 1);
  world.finish({"a"});
  EXPECT_EQ(world.sealedContent(), healthy.sealedContent());
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

TEST_F(CoordinatorTest, TellsPeopleHowFarItIs) {
  solveOrigins();
  Message ask;
  ask.mutable_status_request();
  world.send("operator", ask);
  const auto replies = world.take("operator", Message::kStatusReply);
  ASSERT_EQ(replies.size(), 1u);
  const std::string& json = replies[0].status_reply().json();
  EXPECT_THAT(json, testing::HasSubstr("\"expandable\":1"));
  EXPECT_THAT(json, testing::HasSubstr("\"state\":\"running\""));
  EXPECT_THAT(json, testing::HasSubstr("\"host\":\"here\""));
}

TEST_F(CoordinatorTest, RefusesAJournalWithResultsNobodyAskedFor) {
  {
    const auto [header, payload] = test::solve(world.problem, 0, {1, 0, 0}, {0, 0, 0});
    test::TemporaryDirectory directory;
    const StateDirectory held(directory / "state");
    JobStore store(held, world.problem, encodeProblem(world.problem));
    store.append(header, payload);
    store.commit();
    std::filesystem::copy(directory / "state", world.directory / "stray");
  }
  test::expectError(ExitCode::failed,
                    [&] { Build(world.problem, world.directory / "stray", world.now); },
                    {"nobody asked for", "another version"});
}

/// Whatever of a journal is damaged, what is left of it is used, and the dataset is the same.
TEST_F(CoordinatorTest, ADamagedJournalCostsWhatIsDamagedAndEndsInTheSameBytes) {
  world.join("a", 1);
  world.finish({"a"});
  const ContentId undisturbed = world.sealedContent();
  const std::size_t all = world.coordinator().plans().size() + world.coordinator().recorded();
  const std::filesystem::path segment = world.directory / "state/segment-000001.dat";
  const auto size = std::filesystem::file_size(segment);
  std::mt19937 random(7);
  for (int round = 0; round < 40; ++round) {
    {
      std::fstream file(segment, std::ios::binary | std::ios::in | std::ios::out);
      // Early ones too: all that follows from the origin is not asked for before it is back.
      const auto byte = round == 0 ? 100 : random() % size;
      file.seekp(static_cast<std::streamoff>(byte));
      file.write("damage", 6);
    }
    for (bool sealed = false; !sealed;) {
      world.restart();
      EXPECT_GE(world.coordinator().found() + 4, all / 2) << "most of it is still there";
      world.join("a", 1);
      try {
        world.finish({"a"});
        world.build().verify();
        EXPECT_EQ(world.sealedContent(), undisturbed);
        sealed = true;
      } catch (const DamagedRecord& damage) {
        world.build().drop(damage);
      }
    }
  }
}

}  // namespace
}  // namespace palpate
