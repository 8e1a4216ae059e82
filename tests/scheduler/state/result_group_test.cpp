#include "scheduler/state/result_group.hpp"

#include <gtest/gtest.h>

#include "tests/scheduler/build_world.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;

struct ResultGroupTest : testing::Test {
  test::TemporaryDirectory directory;
  const Problem problem = test::cubeProblem();
  const StateDirectory held{directory / "state"};
  JobStore store{held, problem};
  ResultGroup group{store};
  const ResultGroup::Time now = std::chrono::steady_clock::now();

  ResultKey addOrigin(std::uint32_t space, ResultGroup::Time when) {
    auto [header, payload] = test::solve(problem, space, {0, 0, 0}, {0, 0, 0});
    const ResultKey key{space, {}, {}};
    group.add(key, {header, *fromWire(header), payload, {}}, when);
    return key;
  }
};

TEST_F(ResultGroupTest, RecordsNothingBeforeItIsCommitted) {
  const ResultKey key = addOrigin(0, now);
  EXPECT_NE(group.find(key), nullptr);
  EXPECT_FALSE(store.knows({0, {}, {}}));
}

TEST_F(ResultGroupTest, CommittedResultsAreRecordedAndTheGroupIsEmpty) {
  const ResultKey first = addOrigin(0, now), second = addOrigin(1, now + 5ms);
  group.find(first)->senders = {"a", "b"};
  EXPECT_EQ(group.since(), now) << "the oldest result decides when the group is due";
  const ResultGroup::Members durable = group.commit();
  ASSERT_EQ(durable.size(), 2u);
  EXPECT_EQ(durable.at(first).senders.size(), 2u);
  for (const ResultKey& key : {first, second}) {
    const auto recorded = store.find(key);
    ASSERT_TRUE(recorded);
    EXPECT_EQ(recorded->payload, durable.at(key).payload);
    EXPECT_EQ(recorded->header, durable.at(key).result.SerializeAsString());
  }
  EXPECT_EQ(group.size(), 0u);
  EXPECT_FALSE(group.since());
}

TEST_F(ResultGroupTest, HoldsATransitionOnce) {
  addOrigin(0, now);
  EXPECT_THROW(addOrigin(0, now), std::logic_error);
}

}  // namespace
}  // namespace palpate
