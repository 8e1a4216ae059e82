#include <fstream>
#include <random>

#include "tests/scheduler/service/coordinator_fixture.hpp"
#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;
using wire::Message;

using CoordinatorTest = test::CoordinatorFixture;

Message requestForStartOf(const wire::Job& job) {
  Message message;
  message.mutable_fields_request()->set_id(job.start_id());
  message.mutable_fields_request()->set_space(job.space());
  *message.mutable_fields_request()->mutable_point() = job.start();
  return message;
}

TEST_F(CoordinatorTest, WelcomesAWorkerAndSendsItTheProblem) {
  world.send("a", test::helloOf("a"));
  const auto welcome = world.take("a", Message::kWelcome);
  ASSERT_EQ(welcome.size(), 1u);
  EXPECT_EQ(welcome[0].welcome().build(), problemId(world.problem).bytes());
  EXPECT_EQ(welcome[0].welcome().epoch().size(), 16u);
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
  Message ask = requestForStartOf(jobs[0]);
  world.inbox["a"].clear();
  world.send("a", ask);
  ASSERT_EQ(world.inbox["a"].size(), 1u);
  EXPECT_EQ(ContentId::of(*world.inbox["a"][0].payload).bytes(), jobs[0].start_id());
  ask.mutable_fields_request()->set_id(std::string(32, 'x'));
  world.send("a", ask);
  EXPECT_TRUE(world.inbox["a"][1].message.fields_reply().unknown());
}

/// The scheduler's memory holds a copy of each sent start until the peer reads it.
TEST_F(CoordinatorTest, SendsNoStartsWhileTooManyAreUnread) {
  CoordinatorSettings settings = test::BuildWorld::withoutChecks();
  settings.unread_starts = 2 * originFields().size();
  test::BuildWorld narrow(settings);
  narrow.solveOrigins();
  narrow.request("a", 1);
  const wire::Job job = narrow.takeJobs("a").at(0);
  const Message ask = requestForStartOf(job);
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
  world.pass(3ms);
  EXPECT_TRUE(world.take("a", Message::kResultAck).empty()) << "the group waits for others";
  world.pass(3ms);
  EXPECT_EQ(world.take("a", Message::kResultAck).size(), 1u);
  world.restart();
  EXPECT_EQ(world.coordinator().found(), 1u);
}

TEST_F(CoordinatorTest, ResultsShareASyncWhileMoreAreWaiting) {
  world.join("a", 2);
  const auto jobs = world.takeJobs("a");
  world.deliver("a", jobs[0]);
  world.sleep(15ms);
  world.settle(false);
  EXPECT_TRUE(world.take("a", Message::kResultAck).empty());
  world.sleep(5ms);
  world.settle(false);
  EXPECT_EQ(world.take("a", Message::kResultAck).size(), 1u) << "not forever";
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
  EXPECT_TRUE(world.take("a", Message::kDrain).empty()) << "they may be needed to repair damage";
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

TEST_F(CoordinatorTest, AsksAnEarlierRunsWorkerForAHelloAndTakesItsResult) {
  world.join("a", 1);
  const auto jobs = world.takeJobs("a");
  world.restart();
  world.deliver("a", jobs[0]);
  const auto replies = world.take("a", Message::kHeartbeatReply);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].heartbeat_reply().epoch(), "");
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
  EXPECT_EQ(world.counter("divergent_results"), 0) << "different seconds are not a divergence";
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

TEST_F(CoordinatorTest, TellsAWorkerThatItsResultIsNotNeeded) {
  world.join("a", 2);
  world.deliver("a", 0, toWire(LatticePoint{1, 0, 0}), toWire(LatticePoint{}));
  const auto acks = world.take("a", Message::kResultAck);
  ASSERT_EQ(acks.size(), 1u);
  EXPECT_TRUE(acks.front().result_ack().unwanted());
  EXPECT_EQ(world.counter("unwanted_results"), 1);
  world.restart();
  EXPECT_EQ(world.coordinator().found(), 0u) << "it is not recorded";
}

TEST_F(CoordinatorTest, ANewRequestReplacesEarlierOnes) {
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

TEST_F(CoordinatorTest, DropsInvalidResults) {
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
  EXPECT_EQ(world.take("a", Message::kResultAck).size(), 1u) << "a valid result is still accepted";
}

/// Regression: the largest accepted cause was below limit_point, so such results were dropped,
/// never acknowledged, and sent again forever.
TEST_F(CoordinatorTest, RecordsAndAcknowledgesAResultThatEndedAtALimitPoint) {
  world.join("a", 2);
  const Outcome turned_back = {Failure{.cause = Cause::limit_point, .step_reached = 0.4}, {}};
  world.send("a", originResult([&](wire::Result& r) {
               r.clear_fields_id();
               toWire(turned_back, "", r);
               r.clear_payload_bytes();
             }));
  world.pass(25ms);
  EXPECT_EQ(world.take("a", Message::kResultAck).size(), 1u);
  EXPECT_EQ(world.counter("bad_messages"), 0);
  EXPECT_EQ(world.coordinator().plans()[0].points().record(0).cause, Cause::limit_point);
}

TEST_F(CoordinatorTest, CountsInvalidMessages) {
  world.send("stranger", Message());
  world.join("a", 0);
  world.send("a", Message());
  Message wrong_way;
  wrong_way.mutable_drain();
  world.send("a", wrong_way);
  EXPECT_EQ(world.counter("bad_messages"), 3);
}

TEST_F(CoordinatorTest, SharesReadyTargetsAmongTheLeastLoadedWorkers) {
  solveOrigins();
  world.join("b", 1);
  world.join("c", 1);
  world.request("a", 1);
  for (const char* peer : {"a", "b", "c"}) EXPECT_EQ(world.takeJobs(peer).size(), 1u) << peer;
}

TEST_F(CoordinatorTest, RefusesAJournalWithUnrequestedResults) {
  {
    const auto [header, payload] = test::solve(world.problem, 0, {1, 0, 0}, {0, 0, 0});
    test::TemporaryDirectory directory;
    const StateDirectory held(directory / "state");
    JobStore store(held, world.problem);
    store.append(header, payload);
    store.commit();
    std::filesystem::copy(directory / "state", world.directory / "stray");
  }
  test::expectError(ExitCode::failed,
                    [&] { Build(world.problem, world.directory / "stray", world.now); },
                    {"did not request", "another version"});
}

/// Whatever part of a journal is damaged, the rest is used, and the dataset is the same.
TEST_F(CoordinatorTest, ADamagedJournalLosesOnlyDamageAndEndsInTheSameBytes) {
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
      // Damage early records too: the targets that start at the origin are handed out only after
      // its result.
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
