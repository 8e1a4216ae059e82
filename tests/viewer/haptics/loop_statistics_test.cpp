#include "viewer/haptics/loop_statistics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "viewer/haptics/haptic_tick.hpp"

namespace palpate {
namespace {

TEST(TimeHistogram, GivesQuantilesWithinItsBins) {
  std::mt19937 random(3);
  std::lognormal_distribution<double> times(std::log(5e-6), 1.5);
  TimeHistogram histogram;
  std::vector<double> all;
  for (int n = 0; n < 100000; ++n) {
    all.push_back(times(random));
    histogram.add(all.back());
  }
  std::sort(all.begin(), all.end());
  for (const double share : {0.01, 0.5, 0.9, 0.99, 0.999}) {
    const double exact = all[static_cast<std::size_t>(share * 100000) - 1];
    EXPECT_GE(histogram.quantile(share), exact) << share;
    EXPECT_LE(histogram.quantile(share), 1.0225 * exact) << share;
  }
  EXPECT_EQ(histogram.largest(), all.back());
  EXPECT_EQ(histogram.quantile(1), all.back());
  EXPECT_EQ(histogram.count(), 100000U);
  double sum = 0;
  for (const double time : all) sum += time;
  EXPECT_NEAR(histogram.mean(), sum / 100000, 1e-12);
}

TEST(TimeHistogram, IsEmptyAtFirst) {
  const TimeHistogram histogram;
  EXPECT_EQ(histogram.quantile(0.5), 0);
  EXPECT_EQ(histogram.mean(), 0);
  EXPECT_TRUE(histogram.bins().empty());
}

TEST(TimeHistogram, CountsValuesOutsideItsRange) {
  TimeHistogram histogram;
  for (const double time : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), 1e-9, 100.0})
    histogram.add(time);
  EXPECT_EQ(histogram.count(), 5U);
  EXPECT_EQ(histogram.largest(), 100);
  EXPECT_EQ(histogram.quantile(1), 100);
  ASSERT_EQ(histogram.bins().size(), 2U);
  EXPECT_EQ(histogram.bins().front().count, 4U);
}

TEST(LoopStatistics, CountsGuardsContactsForcesAndSteps) {
  LoopStatistics statistics;
  HapticState before, state;
  state.touch.touching = true;
  state.force = {0, 3, 4};
  state.guards =
      static_cast<std::uint32_t>(Guarded::clamped) | static_cast<std::uint32_t>(Guarded::late);
  count(statistics, before, state);
  count(statistics, state, state);
  before = state;
  state.touch.touching = false;
  state.force = {0, 3, 0};
  state.guards = 0;
  count(statistics, before, state);
  EXPECT_EQ(statistics.ticks, 3U);
  EXPECT_EQ(statistics.contacts, 1U);
  EXPECT_EQ(statistics.guards[2], 2U);
  EXPECT_EQ(statistics.guards[7], 2U);
  EXPECT_EQ(statistics.guards[0], 0U);
  EXPECT_EQ(statistics.largest_force, 5);
  EXPECT_EQ(statistics.largest_step, 5);
}

LoopStatistics someStatistics() {
  LoopStatistics statistics;
  statistics.rate = 1000;
  statistics.ticks = 200;
  for (int n = 0; n < 200; ++n) {
    statistics.period.add(1e-3);
    statistics.compute.add(n == 0 ? 40e-6 : 2e-6);
  }
  statistics.missed_system = 3;
  statistics.missed_program = 1;
  statistics.guards[1] = 50;
  statistics.halts = 2;
  statistics.contacts = 4;
  return statistics;
}

TEST(LoopStatistics, AccumulateOverTheLoopsOfARun) {
  LoopStatistics total, part = someStatistics();
  part.largest_force = 2;
  add(total, part);
  part.largest_force = 1;
  add(total, part);
  EXPECT_EQ(total.rate, 1000);
  EXPECT_EQ(total.ticks, 400U);
  EXPECT_EQ(total.compute.count(), 400U);
  EXPECT_DOUBLE_EQ(total.compute.mean(), part.compute.mean());
  EXPECT_EQ(total.compute.quantile(0.5), part.compute.quantile(0.5));
  EXPECT_EQ(total.missed_system, 6U);
  EXPECT_EQ(total.guards[1], 100U);
  EXPECT_EQ(total.contacts, 8U);
  EXPECT_EQ(total.largest_force, 2);
}

TEST(LoopStatistics, AreWrittenAsJson) {
  const auto json = nlohmann::json::parse(describeJson(someStatistics()));
  EXPECT_EQ(json["ticks"], 200);
  EXPECT_EQ(json["guards"]["damped"], 50);
  EXPECT_NEAR(json["compute_us"]["p50"].get<double>(), 2, 0.05);
  EXPECT_NEAR(json["compute_us"]["largest"].get<double>(), 40, 1e-9);
  ASSERT_EQ(json["compute_us"]["bins"].size(), 2U);
  EXPECT_EQ(json["compute_us"]["bins"][0][1], 199);
  EXPECT_EQ(json["latency_us"]["bins"].size(), 0U);
}

}  // namespace
}  // namespace palpate
