#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iostream>
#include <random>

#include "tests/scheduler/build_world.hpp"
#include "tests/support/lies.hpp"
#include "tests/support/long_tests.hpp"

// Effects of broken or lying workers on the dataset, and on themselves.

namespace palpate {
namespace {

using namespace std::chrono_literals;
using wire::Message;

/// A build by three workers on three machines.
struct LiarWorld : test::BuildWorld {
  explicit LiarWorld(CoordinatorSettings settings = {}, Problem of = test::wideProblem())
      : BuildWorld(settings, std::move(of)) {
    solver = test::solveSmoothly;
  }

  /// The scheduler's objection to the worker; empty if it may join.
  std::string joinFrom(const std::string& host, const std::string& peer) {
    Message hello = test::helloOf(peer);
    hello.mutable_hello()->set_host(host);
    send(peer, hello);
    const auto refused = take(peer, Message::kRefused);
    if (!refused.empty()) return refused[0].refused().reason();
    request(peer, 1);
    return "";
  }
  /// Works until nothing is left for this worker; checks for others then wait.
  void workAlone(const std::string& peer) {
    for (int turns = 0; turns < 400; ++turns) {
      work(peer);
      pass(25ms);
    }
  }
  /// All deliver their targets until a liar is found.
  void turn() {
    for (const std::string peer : {"a", "b", "c"}) work(peer);
    pass(25ms);
  }
  void joinAll() {
    for (const std::string peer : {"a", "b", "c"}) joinFrom("machine-" + peer, peer);
  }

  /// Works until the build is complete or stuck; liars are excluded and the build continues.
  void finishWhateverComes() {
    for (int found = 0; found < 10; ++found) {
      joinAll();
      for (int turns = 0; coordinator().next() == Next::go_on; ++turns) {
        ASSERT_LT(turns, 20000) << "the build does not end";
        turn();
      }
      if (coordinator().next() != Next::anew) return;
      build().keepOut(coordinator().liars());
      restart();
    }
    FAIL() << "more liars than expected";
  }
};

using test::lies;
constexpr auto checking = test::BuildWorld::checking;

ContentId honestContent() {
  LiarWorld world(test::BuildWorld::withoutChecks());
  world.finishWhateverComes();
  return world.sealedContent();
}

struct LiarTest : testing::Test {
  /// Worker "b" tells this lie in its nth result, counted from 0. It does not lie when it checks
  /// the result of another worker, because such a lie is recorded nowhere, and a restarted
  /// scheduler does not know of it.
  void lieOnce(LiarWorld& world, int nth, const test::Lie& lie) {
    world.falsify = [&world, lie, nth, told = 0](const std::string& peer, wire::Result& result,
                                                 std::string& payload) mutable {
      if (peer != "b" || world.coordinator().isChecked(keyOf(result))) return;
      if (told++ == nth) lie(result, payload);
    };
  }
};

TEST_F(LiarTest, AnHonestBuildIsCheckedAndEndsTheSame) {
  LiarWorld world(checking(0.1));
  world.finishWhateverComes();
  EXPECT_EQ(world.sealedContent(), honestContent());
  const auto checked = world.counter("checked_results");
  EXPECT_GE(checked, 8);
  EXPECT_LE(checked, 80) << "of 246";
  EXPECT_EQ(world.counter("unchecked_results"), 0);
}

/// Regression: with many workers, five to seven in a hundred results were solved twice.
TEST_F(LiarTest, ManyWorkersCauseNoMoreChecksThanFew) {
  // 257 points around each of two active nodes. All are solved, because no force ends a path.
  Problem problem = test::cubeProblemOf(2, 0.04, 1300);
  problem.scene.workspace.max_force = 1000;
  LiarWorld world({}, std::move(problem));
  std::vector<std::string> peers;
  for (int n = 0; n < 100; ++n) {
    peers.push_back("worker " + std::to_string(n));
    ASSERT_EQ(world.joinFrom("machine " + std::to_string(n), peers.back()), "");
  }
  world.finish(peers);
  const std::int64_t results = world.coordinator().recorded();
  EXPECT_GE(results, 2 * 257);
  // One result in a hundred is checked, and up to eight odd results in addition.
  EXPECT_LE(world.counter("checked_results"), 0.01 * results + 10) << results;
  EXPECT_GT(world.counter("checked_results"), 0);
  EXPECT_EQ(world.counter("unchecked_results"), 0);
}

TEST_F(LiarTest, ALieIsFoundAndItsWorkersResultsAreSolvedAgain) {
  const ContentId honest = honestContent();
  for (std::size_t kind = 0; kind < lies().size(); ++kind) {
    LiarWorld world;
    lieOnce(world, 40, lies()[kind]);
    world.finishWhateverComes();
    EXPECT_EQ(world.sealedContent(), honest) << "lie " << kind;
    const wire::Status status = world.coordinator().status(world.now);
    ASSERT_EQ(status.kept_out_size(), 1) << "lie " << kind;
    EXPECT_EQ(status.kept_out(0).kind(), "machine");
    EXPECT_EQ(status.kept_out(0).host(), "machine-b");
    EXPECT_THAT(world.joinFrom("machine-b", "b again"),
                testing::HasSubstr("excluded from this build"));
    EXPECT_EQ(world.joinFrom("machine-a", "a again"), "");
  }
}

TEST_F(LiarTest, AWorkerThatIsWrongFromTheStartIsFoundSoon) {
  LiarWorld world;
  int told = 0;
  world.falsify = [&](const std::string& peer, wire::Result& result, std::string& payload) {
    if (peer != "b" || fromWire(result.target()) == LatticePoint{}) return;
    ++told;
    lies()[0](result, payload);
  };
  world.finishWhateverComes();
  EXPECT_LT(told, 30);
  EXPECT_EQ(world.sealedContent(), honestContent());
}

TEST_F(LiarTest, ARestartKeepsChecksAndExclusions) {
  LiarWorld world(checking(1));
  world.joinFrom("machine-a", "a");
  for (int jobs = 0; jobs < 6; ++jobs)
    for (const wire::Job& job : world.takeJobs("a")) {
      world.deliver("a", job);
      world.request("a", 1);
      world.pass(25ms);
    }
  const int open = world.coordinator().status(world.now).checks_open();
  EXPECT_GT(open, 2);
  world.restart();
  EXPECT_EQ(world.coordinator().status(world.now).checks_open(), open);
  // Everything is checked, so this lie is as likely in a check as in a first result.
  world.falsify = [told = 0](const std::string& peer, wire::Result& result,
                             std::string& payload) mutable {
    if (peer == "b" && told++ == 5) lies()[0](result, payload);
  };
  world.finishWhateverComes();
  EXPECT_EQ(world.coordinator().status(world.now).kept_out_size(), 1);
  world.restart();
  EXPECT_THAT(world.joinFrom("machine-b", "b"), testing::HasSubstr("excluded"));
  EXPECT_EQ(world.sealedContent(), honestContent());
}

/// With two workers, nobody can tell which one is right.
TEST_F(LiarTest, ADisputeEndsTheBuildUntilAThirdWorkerSettlesIt) {
  LiarWorld world;
  world.joinFrom("machine-a", "a");
  world.joinFrom("machine-b", "b");
  lieOnce(world, 40, lies()[0]);
  for (int turns = 0; !world.coordinator().complete() && !world.coordinator().stuck(); ++turns) {
    ASSERT_LT(turns, 20000);
    for (const std::string peer : {"a", "b"}) world.work(peer);
    world.pass(25ms);
  }
  EXPECT_TRUE(world.coordinator().stuck());
  EXPECT_EQ(world.coordinator().disputedCount(), 1u);
  world.restart();
  EXPECT_FALSE(world.coordinator().stuck()) << "others may come";
  world.finishWhateverComes();
  EXPECT_EQ(world.coordinator().status(world.now).kept_out_size(), 1);
  EXPECT_EQ(world.sealedContent(), honestContent());
}

TEST_F(LiarTest, ASingleMachineIsNotCheckedAndDoesNotWait) {
  LiarWorld world(checking(0.2));
  world.joinFrom("machine-a", "a");
  world.joinFrom("machine-a", "b");
  const auto began = world.now;
  world.finish({"a", "b"});
  EXPECT_LT(world.now - began, CoordinatorSettings().checks_wait);
  EXPECT_EQ(world.counter("checked_results"), 0);
  EXPECT_EQ(world.counter("unchecked_results"), 0);
  EXPECT_EQ(world.coordinator().status(world.now).checks_open(), 0);
  EXPECT_EQ(world.sealedContent(), honestContent());
}

/// Workers that take no more work, or hoard it, do not delay the end of a build.
TEST_F(LiarTest, ChecksForASecondMachineAreNotForgotten) {
  LiarWorld world(checking(1));
  world.joinFrom("machine-a", "a");
  const wire::Job first = world.takeJobs("a").at(0);
  world.deliver("a", first);
  world.pass(25ms);
  world.joinFrom("machine-b", "b");
  const wire::Job check = world.takeJobs("b").at(0);
  EXPECT_EQ(fromWire(check.targets(0).point()), fromWire(first.targets(0).point()));
}

/// One process has a memory fault now and then; the other processes of its machine give right
/// results.
TEST_F(LiarTest, ADisputeOnOneMachineIsSettledByItsThirdProcess) {
  LiarWorld world(test::BuildWorld::withoutChecks());
  for (const std::string peer : {"a", "b", "c"}) world.joinFrom("machine", peer);
  const wire::Job job = world.takeJobs("a").at(0);
  world.send("a", test::helloOf("a"));  // it has forgotten the job, but completes it
  world.pass(25ms);
  const wire::Job again = world.takeJobs("c").at(0);
  world.falsify = [](const std::string& peer, wire::Result& result, std::string&) {
    if (peer == "c") result.mutable_cost()->set_steps(77);
  };
  world.deliver("c", again);
  world.pass(25ms);
  world.deliver("a", job);
  EXPECT_EQ(world.coordinator().disputedCount(), 1u);
  world.request("b", 4);
  for (const wire::Job& check : world.takeJobs("b")) world.deliver("b", check);
  const std::vector<KeptOut>& liars = world.coordinator().liars();
  ASSERT_EQ(liars.size(), 1u);
  EXPECT_EQ(liars[0].kind, KeptOut::Kind::process);
  EXPECT_EQ(liars[0].who.worker(), "c");
}

TEST_F(LiarTest, ChecksThatNoWorkerRequestsAreGivenUp) {
  LiarWorld world(checking(0.2));
  world.joinFrom("machine-a", "a");
  world.send("b", test::helloOf("b"));
  for (int turns = 0; !world.coordinator().complete(); ++turns) {
    ASSERT_LT(turns, 20000);
    world.work("a");
    world.beat("b");
    world.pass(50ms);
  }
  EXPECT_GT(world.counter("unchecked_results"), 0);
}

/// Inconsistent branches are solved again in several steps; a check has to use as many.
TEST_F(LiarTest, ASolveInSeveralStepsIsCheckedInAsMany) {
  LiarWorld world(checking(1));
  world.solver = test::solve;
  world.finishWhateverComes();
  EXPECT_TRUE(world.coordinator().complete());
  EXPECT_EQ(world.coordinator().status(world.now).kept_out_size(), 0);
  EXPECT_EQ(world.counter("divergent_results"), 0);
  EXPECT_GT(world.counter("checked_results"), world.coordinator().recorded() / 2);
  int in_steps = 0;
  readResults(world.directory / "state", problemId(world.problem),
              [&](const ResultKey&, const wire::Result& result, const Outcome&) {
                in_steps += result.steps() > 1;
              });
  EXPECT_GT(in_steps, 10) << "otherwise nothing was tested";
}

/// A checked result may be recorded again: after a restart between the verdict and the exclusion,
/// or if it was solved from the result of a liar.
TEST_F(LiarTest, ALiarNotExcludedBecauseOfAKillIsFoundAgain) {
  const ContentId honest = honestContent();
  LiarWorld world;
  lieOnce(world, 40, lies()[0]);
  world.joinAll();
  for (int turns = 0; turns < 20000 && world.coordinator().next() == Next::go_on; ++turns)
    world.turn();
  EXPECT_EQ(world.coordinator().next(), Next::anew);
  world.restart();
  EXPECT_GT(world.coordinator().status(world.now).checks_open(), 0);
  world.finishWhateverComes();
  EXPECT_EQ(world.coordinator().status(world.now).kept_out_size(), 1)
      << toJson(world.coordinator().status(world.now));
  EXPECT_EQ(world.sealedContent(), honest);
}

TEST_F(LiarTest, ChecksAreNotGivenUpDuringAnOperatorsPause) {
  LiarWorld world(checking(0.2));
  world.joinFrom("machine-a", "a");
  world.send("b", test::helloOf("b"));
  world.workAlone("a");
  ASSERT_GT(world.coordinator().status(world.now).checks_open(), 0);
  world.coordinator().pause(true);
  for (int seconds = 0; seconds < 120; ++seconds) {
    world.beat("a");
    world.pass(1s);
  }
  EXPECT_FALSE(world.coordinator().complete());
  world.coordinator().pause(false);
  world.joinFrom("machine-b", "b");
  world.finish({"a", "b"});
  EXPECT_EQ(world.counter("unchecked_results"), 0);
}

/// The last checks are of the results of worker "a". It returns first after a restart, and the
/// checks wait for another machine.
TEST_F(LiarTest, ChecksWaitForWorkersThatMayReturn) {
  LiarWorld world(checking(1));
  world.joinFrom("machine-b", "b");
  const wire::Job first = world.takeJobs("b").at(0);
  world.deliver("b", first);
  world.joinFrom("machine-a", "a");
  world.workAlone("a");
  ASSERT_FALSE(world.coordinator().complete());
  world.restart();
  world.joinFrom("machine-a", "a");
  world.pass(14s);
  EXPECT_FALSE(world.coordinator().complete());
  EXPECT_GT(world.coordinator().status(world.now).checks_open(), 200);
  world.beat("a");
  world.pass(2s);
  EXPECT_TRUE(world.coordinator().complete()) << "nobody came";
  EXPECT_GT(world.counter("unchecked_results"), 200);
}

TEST_F(LiarTest, AKeyDoesNotCheckItselfUnderAnotherName) {
  LiarWorld world(checking(1));
  const PublicKey liar = KeyPair::make().open(), honest = KeyPair::make().open();
  world.key_of = {{"l1", liar}, {"l2", liar}, {"h", honest}};
  world.joinFrom("machine-l1", "l1");
  const wire::Job first = world.takeJobs("l1").at(0);
  world.deliver("l1", first);
  world.pass(25ms);
  world.joinFrom("machine-h", "h");
  world.joinFrom("machine-l2", "l2");
  const auto isFirst = [&](const wire::Job& job) {
    return job.space() == first.space() &&
           fromWire(job.targets(0).point()) == fromWire(first.targets(0).point());
  };
  world.request("l2", 8);
  EXPECT_TRUE(std::ranges::none_of(world.takeJobs("l2"), isFirst));
  EXPECT_TRUE(std::ranges::any_of(world.takeJobs("h"), isFirst));
}

/// An idle worker with a second key cannot prevent two workers that share the first key from
/// checking each other.
TEST_F(LiarTest, AnIdleSecondKeyPreventsNoCheck) {
  LiarWorld world(checking(1));
  const PublicKey liar = KeyPair::make().open(), honest = KeyPair::make().open();
  world.key_of = {{"l", liar}, {"a", honest}, {"b", honest}};
  world.send("l", test::helloOf("l"));
  world.joinFrom("machine-a", "a");
  world.joinFrom("machine-b", "b");
  for (int turns = 0; turns < 3000 && !world.coordinator().complete(); ++turns) {
    for (const std::string peer : {"a", "b"}) world.work(peer);
    world.beat("l");
    world.pass(50ms);
  }
  EXPECT_TRUE(world.coordinator().complete());
  EXPECT_EQ(world.counter("unchecked_results"), 0);
  EXPECT_GT(world.counter("checked_results"), 200);
}

TEST_F(LiarTest, AKeyThatContradictsItselfIsFinallyExcluded) {
  LiarWorld world(test::BuildWorld::withoutChecks());
  const PublicKey liar = KeyPair::make().open();
  lieOnce(world, 0, [](wire::Result&, std::string&) {});
  bool kept_out = false;
  for (int round = 0; round < 8 && !kept_out; ++round) {
    const std::string name = "liar " + std::to_string(round);
    world.key_of[name] = liar;
    kept_out = !world.joinFrom("machine-" + std::to_string(round), name).empty();
    if (kept_out) break;
    const wire::Job job = world.takeJobs(name).at(0);
    world.deliver(name, job);
    world.pass(25ms);
    world.falsify = [](const std::string&, wire::Result& r, std::string&) {
      r.mutable_cost()->set_newton_iterations(77);
    };
    world.deliver(name, job);
    ASSERT_EQ(world.coordinator().next(), Next::anew) << "nobody minds";
    world.build().keepOut(world.coordinator().liars());
    world.restart();
    world.falsify = nullptr;
  }
  EXPECT_TRUE(kept_out);
}

/// One of three workers falsifies one in a hundred of its results, in one of four ways. Most builds
/// are too small for more than one lie.
TEST_F(LiarTest, NinetyNinePercentOfBuildsWithALiarAreRepairedOrRefused) {
  const int builds = test::longTestsAreWanted() ? 1000 : 30;
  const ContentId honest = honestContent();
  int with_lies = 0, spoiled = 0, found = 0;
  for (int seed = 0; seed < builds; ++seed) {
    LiarWorld world;
    std::mt19937 random(static_cast<unsigned>(seed));
    int told = 0;
    world.falsify = [&](const std::string& peer, wire::Result& result, std::string& payload) {
      if (peer != "b" || fromWire(result.target()) == LatticePoint{} || random() % 100 != 0) return;
      ++told;
      lies()[random() % lies().size()](result, payload);
    };
    world.finishWhateverComes();
    with_lies += told > 0;
    const bool kept_out = world.coordinator().status(world.now).kept_out_size() > 0;
    found += kept_out;
    EXPECT_LE(kept_out, told > 0) << "seed " << seed << ": no honest worker is excluded";
    spoiled += world.coordinator().complete() && world.sealedContent() != honest;
  }
  std::cout << fmt::format("{} builds, {} with lies, {} liars found, {} datasets spoiled\n", builds,
                           with_lies, found, spoiled);
  EXPECT_GE(with_lies, builds / 3) << "otherwise nothing was tested";
  EXPECT_LE(100 * spoiled, with_lies);
}

}  // namespace
}  // namespace palpate
