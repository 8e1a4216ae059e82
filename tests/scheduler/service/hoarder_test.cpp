#include <gtest/gtest.h>

#include "tests/scheduler/build_world.hpp"

// Workers that take work without doing it.

namespace palpate {
namespace {

using namespace std::chrono_literals;

CoordinatorSettings usual() { return test::BuildWorld::checking(0); }

struct HoarderTest : testing::Test {
  test::BuildWorld world{usual()};

  static std::size_t targetsOf(const std::vector<wire::Job>& jobs) {
    std::size_t count = 0;
    for (const wire::Job& job : jobs) count += static_cast<std::size_t>(job.targets_size());
    return count;
  }
  /// Claims to be solving the first target, without doing so.
  void pretend(const std::string& peer) {
    auto& held = held_[peer];
    for (wire::Job& job : world.takeJobs(peer)) held.push_back(std::move(job));
    world.beat(peer, held.empty() ? nullptr : &held.front());
  }
  /// Delivers all its targets in `steps` steps of 50 ms.
  int work(const std::string& peer, int steps) {
    int delivered = 0;
    for (int n = 0; n < steps && !world.coordinator().complete(); ++n) {
      delivered += world.work(peer);
      world.pass(50ms);
    }
    return delivered;
  }

 private:
  std::map<std::string, std::vector<wire::Job>> held_;
};

TEST_F(HoarderTest, ANewWorkerHoldsTwoTargetsWhateverItRequests) {
  world.join("a", 2);
  work("a", 20);
  world.join("hoarder", 4'000'000'000);
  work("a", 1);
  EXPECT_LE(targetsOf(world.takeJobs("hoarder")), 2u);
}

TEST_F(HoarderTest, AWorkerMayHoldAsMuchAsItDelivered) {
  world.join("a", 64);
  std::size_t delivered = 0, most = 0;
  for (int turns = 0; turns < 30; ++turns) {
    std::vector<wire::Job> jobs = world.takeJobs("a");
    EXPECT_LE(targetsOf(jobs), std::max<std::size_t>(delivered, 2));
    most = std::max(most, targetsOf(jobs));
    for (const wire::Job& job : jobs) world.deliver("a", job);
    delivered += targetsOf(jobs);
    world.pass(50ms);
  }
  EXPECT_GT(most, 4u);
}

/// Thirty workers with endless credit claim to be busy forever; one works.
TEST_F(HoarderTest, ABuildEndsDespiteThirtyHoarders) {
  world.join("a", 2);
  work("a", 4);
  for (int n = 0; n < 30; ++n) world.join("hoarder " + std::to_string(n), 4'000'000'000);
  int seconds = 0;
  for (; seconds < 120 && !world.coordinator().complete(); ++seconds) {
    work("a", 20);
    for (int n = 0; n < 30; ++n) pretend("hoarder " + std::to_string(n));
  }
  EXPECT_TRUE(world.coordinator().complete());
  EXPECT_LT(seconds, 60);
  EXPECT_GT(world.counter("overdue_targets"), 0);
}

/// A worker that rejoins repeatedly does not delay others longer each time.
TEST_F(HoarderTest, AReturningHoarderDelaysTheLastTargetsBySecondsOnly) {
  world.join("a", 2);
  work("a", 10);
  int seconds = 0;
  for (; seconds < 200 && !world.coordinator().complete(); ++seconds) {
    for (int n = 0; n < 5; ++n) world.join("hoarder", 64);
    work("a", 20);
  }
  EXPECT_TRUE(world.coordinator().complete());
}

/// The hoarder holds the check of the last result.
TEST_F(HoarderTest, AHoarderOfChecksDelaysTheEndByAMinuteAtMost) {
  test::BuildWorld checked(test::BuildWorld::checking(1));
  checked.join("a", 2);
  int seconds = 0;
  for (; seconds < 200 && !checked.coordinator().complete(); ++seconds) {
    if (seconds == 2) {
      wire::Message hello = test::helloOf("hoarder");
      hello.mutable_hello()->set_host("elsewhere");
      checked.send("hoarder", hello);
      checked.request("hoarder", 64);
    }
    for (int n = 0; n < 20; ++n) {
      checked.work("a");
      checked.pass(50ms);
    }
    checked.beat("a");
    if (seconds > 2) checked.beat("hoarder");
  }
  EXPECT_TRUE(checked.coordinator().complete());
  EXPECT_GT(checked.counter("overdue_targets"), 0);
  EXPECT_LT(seconds, 90);
}

TEST_F(HoarderTest, AnIdleOrSilentHoarderDelaysNothing) {
  for (const bool beats : {false, true}) {
    test::BuildWorld alone(usual());
    alone.join("a", 2);
    alone.join("hoarder", 64);
    for (int seconds = 0; seconds < 120 && !alone.coordinator().complete(); ++seconds) {
      for (int n = 0; n < 20; ++n) {
        alone.work("a");
        alone.pass(50ms);
      }
      if (beats) alone.beat("hoarder");
    }
    EXPECT_TRUE(alone.coordinator().complete()) << beats;
  }
}

/// Its late result is accepted, and it gets work again.
TEST_F(HoarderTest, ASlowWorkerGetsWorkAgainOnceItDelivers) {
  world.join("a", 2);
  work("a", 6);
  world.join("slow", 1);
  std::vector<wire::Job> held;
  for (int n = 0; n < 200 && held.empty(); ++n) {
    work("a", 1);
    held = world.takeJobs("slow");
  }
  ASSERT_EQ(held.size(), 1u);
  for (int n = 0; n < 2000 && world.counter("overdue_targets") == 0; ++n) {
    work("a", 1);
    if (n % 20 == 0) world.beat("slow", held.data());
  }
  ASSERT_GT(world.counter("overdue_targets"), 0);
  world.request("slow", 4);
  EXPECT_TRUE(world.takeJobs("slow").empty());
  world.deliver("slow", held[0]);
  EXPECT_EQ(world.counter("divergent_results"), 0);
  if (world.coordinator().complete()) return;
  for (int n = 0; n < 200 && !world.coordinator().complete(); ++n) {
    work("a", 1);
    if (!world.takeJobs("slow").empty()) return;
  }
  EXPECT_TRUE(world.coordinator().complete()) << "otherwise it would have received work";
}

}  // namespace
}  // namespace palpate
