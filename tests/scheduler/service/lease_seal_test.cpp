#include "scheduler/service/lease_seal.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

const ResultKey transition = {1, {2, 3, 4}, {2, 3, 3}};
constexpr std::string_view secret = "32 bytes that nobody else knows.";

TEST(LeaseSeal, IsValidForOneWorkerTransitionAndStart) {
  const Leased leased{"worker", transition, "start"};
  const std::string text = leaseSeal(leased, secret);
  EXPECT_TRUE(isLeaseSeal(text, leased, secret));
  EXPECT_TRUE(isLeaseSeal(text, leased, std::string(secret))) << "after a restart too";
  EXPECT_FALSE(isLeaseSeal(text, leased, std::string(32, 't')));

  ResultKey other = transition;
  other.space = 0;
  EXPECT_FALSE(isLeaseSeal(text, {"worker", other, "start"}, secret));
  other = transition;
  other.target[0] += 1;
  EXPECT_FALSE(isLeaseSeal(text, {"worker", other, "start"}, secret));
  EXPECT_FALSE(isLeaseSeal(text, {"another", transition, "start"}, secret));
  EXPECT_FALSE(isLeaseSeal(text, {"worker", transition, ""}, secret));
  EXPECT_FALSE(isLeaseSeal(text, {"workers", transition, "tart"}, secret));
}

TEST(LeaseSeal, OtherBytesAreInvalid) {
  const Leased leased{"worker", transition, "start"};
  std::string flipped = leaseSeal(leased, secret);
  flipped[3] = static_cast<char>(flipped[3] ^ 1);
  EXPECT_FALSE(isLeaseSeal(flipped, leased, secret));
  EXPECT_FALSE(isLeaseSeal("", leased, secret));
  EXPECT_FALSE(isLeaseSeal(leaseSeal(leased, secret) + "x", leased, secret));
}

}  // namespace
}  // namespace palpate
