#include "common/wire/wire.hpp"

#include <gtest/gtest.h>

#include "tests/support/causes.hpp"
#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

using test::expectBadInput;

TEST(Endpoint, IsAHostAndAPortOrAPath) {
  for (const char* good : {"tcp://127.0.0.1:7411", "tcp://localhost:1", "tcp://[::1]:65535",
                           "tcp://*:7411", "tcp://127.0.0.1:*", "ipc:///run/palpate"})
    EXPECT_NO_THROW(checkEndpoint(good)) << good;
}

TEST(Endpoint, IsRefusedSayingHowToWriteOne) {
  for (const char* bad :
       {"", "localhost:7411", "http://localhost:7411", "tcp://", "tcp://localhost", "tcp://:7411",
        "tcp://localhost:", "tcp://localhost:99999", "tcp://localhost:7411x"})
    expectBadInput([&] { checkEndpoint(bad); }, {"tcp://HOST:PORT"});
}

TEST(WireResult, CarriesFailuresOfEveryCauseThatStopsTransitions) {
  for (const Cause cause : test::allCauses()) {
    if (!stopsTransitions(cause)) continue;
    Outcome outcome;
    outcome.failure = {cause, 0.75, 2e-3, 11, 0.125, 28, 27, -9, 4096};
    wire::Result result;
    toWire(outcome, "", result);
    const auto again = fromWire(result);
    ASSERT_TRUE(again) << name(cause);
    EXPECT_EQ(again->failure.cause, cause);
    EXPECT_EQ(describe(again->failure), describe(outcome.failure));
  }
}

TEST(WireResult, CarriesWhatDrivesAFingerAndNothingOfItForOtherTools) {
  Outcome outcome;
  outcome.converged = true;
  wire::Result plain;
  toWire(outcome, "fields", plain);
  EXPECT_TRUE(plain.equilibrium().drive().empty());
  outcome.equilibrium.drive = {1, -2, 3};
  outcome.equilibrium.drive_stiffness << 1, 2, 3, 4, 5, 6, 7, 8, 9;
  outcome.equilibrium.drive_slope = Eigen::Matrix3d::Identity();
  outcome.equilibrium.stiffness_by_p(2, 1) = 4;
  outcome.equilibrium.stiffness_by_s(0, 2) = 5;
  outcome.equilibrium.drive_slope_by_p(5, 0) = 6;
  wire::Result result;
  toWire(outcome, "fields", result);
  const auto again = fromWire(result);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->equilibrium.drive, outcome.equilibrium.drive);
  EXPECT_EQ(again->equilibrium.drive_stiffness, outcome.equilibrium.drive_stiffness);
  EXPECT_EQ(again->equilibrium.drive_slope, outcome.equilibrium.drive_slope);
  EXPECT_EQ(again->equilibrium.stiffness_by_p, outcome.equilibrium.stiffness_by_p);
  EXPECT_EQ(again->equilibrium.stiffness_by_s, outcome.equilibrium.stiffness_by_s);
  EXPECT_EQ(again->equilibrium.drive_slope_by_p, outcome.equilibrium.drive_slope_by_p);
  result.mutable_equilibrium()->set_drive("short");
  EXPECT_FALSE(fromWire(result));
}

TEST(WireResult, OfAnotherCauseIsNone) {
  for (const std::uint32_t value :
       {0u, static_cast<std::uint32_t>(Cause::unreachable), 200u, 257u}) {
    wire::Result result;
    result.mutable_failure()->set_cause(value);
    EXPECT_FALSE(fromWire(result)) << value;
  }
}

}  // namespace
}  // namespace palpate
