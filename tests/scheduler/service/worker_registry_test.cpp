#include "scheduler/service/worker_registry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scheduler/build_world.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;

struct WorkerRegistryTest : testing::Test {
  WorkerRegistry registry{""};
  Leases leases;
  const Worker::Time now = std::chrono::steady_clock::now();

  static wire::Hello hello(const std::string& id, std::uint32_t pid = 1) {
    return test::helloOf(id, pid).hello();
  }
  Worker& admit(const std::string& peer, const std::string& id, std::uint32_t pid = 1) {
    return registry.admit(peer, hello(id, pid), {}, now);
  }
};

TEST_F(WorkerRegistryTest, AWorkerWithoutAnIdOrKernelsMayNotJoin) {
  wire::Hello nameless = hello("");
  EXPECT_THAT(registry.objectionTo(nameless, {}), testing::HasSubstr("id"));
  EXPECT_THAT(registry.objectionTo(hello(std::string(65, 'x')), {}), testing::HasSubstr("id"));
  wire::Hello without = hello("a");
  without.clear_kernel_family();
  EXPECT_THAT(registry.objectionTo(without, {}), testing::HasSubstr("kernel family"));
  for (const std::string& name : {std::string("\x1b[2J"), std::string(65, 'x')}) {
    wire::Hello unprintable = hello("a");
    unprintable.set_kernel_family(name);
    EXPECT_THAT(registry.objectionTo(unprintable, {}), testing::HasSubstr("not printable"));
  }
}

TEST_F(WorkerRegistryTest, AWorkerOfAnotherVersionOrCommitMayNotJoin) {
  EXPECT_EQ(registry.objectionTo(hello("a"), {}), "") << "its commit is unknown";
  wire::Hello named = hello("a");
  named.set_version(buildName());
  EXPECT_EQ(registry.objectionTo(named, {}), "");
  named.set_version("0.0.7 (1a2b3c4)");
  EXPECT_THAT(registry.objectionTo(named, {}), testing::HasSubstr("0.0.7 (1a2b3c4)"));

  EXPECT_TRUE(isSameBuild("0.1.0 (1a2b3c4)", "0.1.0 (1a2b3c4)"));
  EXPECT_FALSE(isSameBuild("0.1.0 (1a2b3c4)", "0.1.0 (9f8e7d6)"));
  EXPECT_FALSE(isSameBuild("0.1.0 (1a2b3c4)", "0.1.0 (1a2b3c4+changed)"));
  EXPECT_TRUE(isSameBuild("0.1.0 (1a2b3c4)", "0.1.0")) << "built without git";
  EXPECT_FALSE(isSameBuild("0.1.0", "0.2.0"));
}

TEST_F(WorkerRegistryTest, AWorkersNameCannotMoveTheCursor) {
  wire::Hello escaping = hello("a");
  escaping.set_host("\x1b[2Jnode\n7 " + std::string(1000, 'x'));
  EXPECT_EQ(registry.admit("p", escaping, {}, now).provenance.host(),
            "?[2Jnode?7 " + std::string(53, 'x'));
  escaping.set_version("\x1b[2J");
  EXPECT_THAT(registry.objectionTo(escaping, {}), testing::HasSubstr("palpate ?[2J:"));
}

TEST_F(WorkerRegistryTest, IsLimitedButTakesBackKnownWorkers) {
  for (std::size_t i = 0; i < WorkerRegistry::most_workers; ++i)
    admit(std::to_string(i), std::to_string(i));
  EXPECT_THAT(registry.objectionTo(hello("one more"), {}), testing::HasSubstr("10000 workers"));
  EXPECT_EQ(registry.objectionTo(hello("7"), {}), "");
}

TEST_F(WorkerRegistryTest, AWorkerThatComesBackKeepsItsResultsAndNothingElse) {
  Worker& worker = admit("before", "a");
  registry.addCredit(worker, 3);
  worker.results = 7;
  worker.solving = ResultKey{0, {1, 0, 0}, {}};
  const Worker& again = admit("after", "a");
  EXPECT_EQ(registry.all().size(), 1u);
  EXPECT_EQ(again.results, 7);
  EXPECT_EQ(again.credit, 0u);
  EXPECT_FALSE(again.solving);
  EXPECT_EQ(registry.ofPeer("before"), nullptr);
  EXPECT_EQ(registry.ofPeer("after"), &again);
}

TEST_F(WorkerRegistryTest, APeerIsOneWorker) {
  admit("p", "a");
  EXPECT_THROW(admit("p", "b"), std::logic_error);
}

TEST_F(WorkerRegistryTest, CreditIsBounded) {
  Worker& worker = admit("p", "a");
  registry.addCredit(worker, 0xffffffff);
  EXPECT_EQ(worker.credit, WorkerRegistry::most_credit);
  registry.addCredit(worker, 0xffffffff);
  EXPECT_EQ(worker.credit, WorkerRegistry::most_credit);
}

TEST_F(WorkerRegistryTest, KnowsWhichWorkersRequestWork) {
  EXPECT_FALSE(registry.someoneAsks());
  for (const char* id : {"a", "b", "c", "d"}) registry.addCredit(admit(id, id), 1);
  registry.find("b")->credit = 0;
  registry.remove(*registry.find("c"), "left", now);
  std::vector<std::string> asking;
  registry.eachAsking([&](const Worker& worker) {
    asking.push_back(worker.id);
    return true;
  });
  EXPECT_THAT(asking, testing::ElementsAre("a", "d"));
  EXPECT_TRUE(registry.someoneAsks());
  registry.find("a")->credit = registry.find("d")->credit = 0;
  EXPECT_FALSE(registry.someoneAsks());
  registry.addCredit(*registry.find("b"), 2);
  EXPECT_TRUE(registry.someoneAsks());
}

TEST_F(WorkerRegistryTest, ItsRowsShowBusyAndDepartedWorkers) {
  admit("p", "a", 1);
  admit("q", "b", 2);
  leases.add({0, 0, 0});
  leases.handOut("b", 2);
  const auto rows = registry.rows(leases, now + 3s);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].worker(), "61");
  EXPECT_EQ(rows[0].state(), "idle");
  EXPECT_EQ(rows[0].heard_seconds_ago(), 3);
  EXPECT_EQ(rows[1].state(), "busy");
  registry.remove(*registry.find("b"), "lost", now);
  EXPECT_EQ(registry.ofPeer("q"), nullptr);
  const auto departed = registry.takeDeparted();
  ASSERT_EQ(departed.size(), 1u);
  EXPECT_EQ(departed[0].state(), "lost");
  EXPECT_TRUE(registry.takeDeparted().empty());
}

}  // namespace
}  // namespace palpate
