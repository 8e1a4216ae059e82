#include "scheduler/fleet/fleet.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr FleetLimits limits{.most = 20, .most_queued = 8, .transitions_each = 2};

TEST(FleetDemand, AsksForOneWorkerForTheFirstTransition) {
  EXPECT_EQ(moreWorkers({.ready = 1}, limits), 1);
  EXPECT_EQ(moreWorkers({.ready = 1, .queued = 1}, limits), 0);
  EXPECT_EQ(moreWorkers({.ready = 1, .running = 1}, limits), 0);
}

TEST(FleetDemand, GrowsWithTheFrontierAndKeepsTheQueueShort) {
  EXPECT_EQ(moreWorkers({.ready = 10}, limits), 5);
  EXPECT_EQ(moreWorkers({.ready = 1000}, limits), 8);
  EXPECT_EQ(moreWorkers({.ready = 1000, .queued = 8}, limits), 0);
  EXPECT_EQ(moreWorkers({.ready = 1000, .queued = 3, .running = 5}, limits), 5);
}

TEST(FleetDemand, NeverExceedsTheMaximumHoweverMuchIsReady) {
  EXPECT_EQ(moreWorkers({.ready = 1000, .queued = 2, .running = 15}, limits), 3);
  EXPECT_EQ(moreWorkers({.ready = 1000, .running = 25}, limits), 0);
}

TEST(FleetDemand, CancelsQueuedWorkersWhenThereIsNoWork) {
  EXPECT_EQ(moreWorkers({.ready = 4, .queued = 6, .running = 1}, limits), -5);
  EXPECT_EQ(moreWorkers({.ready = 0, .queued = 6, .running = 4}, limits), -6);
  EXPECT_EQ(moreWorkers({.ready = 1000, .queued = 6, .hands_out = false}, limits), -6);
}

}  // namespace
}  // namespace palpate
