#include "scheduler/service/allotment.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

using namespace std::chrono_literals;

struct AllotmentTest : testing::Test {
  Allotment allotment;
  Allotment::Time now{};

  void deliver(Worker& worker, int times, std::chrono::milliseconds after) {
    for (int n = 0; n < times; ++n) {
      now += after;
      allotment.noteDelivery(worker, now);
    }
  }
  /// Both deliver; `usual` delivers `times` results for each one of `slow`.
  void deliverBeside(Worker& usual, Worker& slow, int times) {
    for (int n = 0; n < 60; ++n) {
      deliver(usual, times, 10ms);
      allotment.noteDelivery(slow, now);
    }
  }
};

TEST_F(AllotmentTest, ANewWorkerHoldsTwoAndOthersAsManyAsTheyDelivered) {
  Worker worker;
  EXPECT_EQ(allotment.limitOf(worker, now), 2u);
  deliver(worker, 7, 10ms);
  EXPECT_EQ(allotment.limitOf(worker, now), 7u);
  deliver(worker, 1000, 10ms);
  EXPECT_EQ(allotment.limitOf(worker, now), 2 * max_targets_per_job);
}

/// With as many targets as other workers, the slow worker would finish last, and the others would
/// wait.
TEST_F(AllotmentTest, AWorkerSevenTimesSlowerHoldsAFractionOfOthers) {
  Worker usual, slow;
  deliverBeside(usual, slow, 7);
  EXPECT_EQ(allotment.limitOf(usual, now), 2 * max_targets_per_job);
  EXPECT_GE(allotment.limitOf(slow, now), 52u / 7);
  EXPECT_LE(allotment.limitOf(slow, now), 52u / 3);
}

TEST_F(AllotmentTest, AnEquallyFastWorkerHoldsAsMuchAsOthers) {
  Worker usual, other;
  deliverBeside(usual, other, 1);
  EXPECT_EQ(allotment.limitOf(usual, now), 2 * max_targets_per_job);
  EXPECT_GE(allotment.limitOf(other, now), 2 * max_targets_per_job - 4);
}

TEST_F(AllotmentTest, AnOverdueWorkerGetsNothingUntilItDeliversOrAPauseEnds) {
  Worker worker;
  deliver(worker, 20, 100ms);
  EXPECT_FALSE(allotment.isOverdue(worker, 1, now + 1900ms));
  EXPECT_TRUE(allotment.isOverdue(worker, 1, now + 2s)) << "2 s at least";
  EXPECT_FALSE(allotment.isOverdue(worker, 2, now + 2s)) << "twice as long for the second";
  now += 2s;
  allotment.noteOverdue(worker, now);
  EXPECT_EQ(allotment.limitOf(worker, now), 0u);
  EXPECT_EQ(allotment.limitOf(worker, now + 30s), 2u) << "like a new worker";
  deliver(worker, 1, 10ms);
  EXPECT_EQ(allotment.limitOf(worker, now), 2u);
}

}  // namespace
}  // namespace palpate
