#include "scheduler/service/lease_seal.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

const ResultKey transition = {1, {2, 3, 4}, {2, 3, 3}};

TEST(LeaseSeal, IsValidForOneWorkerTransitionAndStart) {
  const LeaseSeal seal(std::string(32, 's'));
  const Leased leased{"worker", transition, "start"};
  const std::string text = seal.sealOf(leased);
  EXPECT_TRUE(seal.isSealOf(leased, text));
  EXPECT_TRUE(LeaseSeal(std::string(32, 's')).isSealOf(leased, text)) << "after a restart too";
  EXPECT_FALSE(LeaseSeal(std::string(32, 't')).isSealOf(leased, text));

  ResultKey other = transition;
  other.space = 0;
  EXPECT_FALSE(seal.isSealOf({"worker", other, "start"}, text));
  other = transition;
  other.target[0] += 1;
  EXPECT_FALSE(seal.isSealOf({"worker", other, "start"}, text));
  EXPECT_FALSE(seal.isSealOf({"another", transition, "start"}, text));
  EXPECT_FALSE(seal.isSealOf({"worker", transition, ""}, text));
  EXPECT_FALSE(seal.isSealOf({"workers", transition, "tart"}, text));
}

TEST(LeaseSeal, OtherBytesAreInvalid) {
  const LeaseSeal seal(std::string(32, 's'));
  const Leased leased{"worker", transition, "start"};
  std::string flipped = seal.sealOf(leased);
  flipped[3] = static_cast<char>(flipped[3] ^ 1);
  EXPECT_FALSE(seal.isSealOf(leased, flipped));
  EXPECT_FALSE(seal.isSealOf(leased, ""));
  EXPECT_FALSE(seal.isSealOf(leased, seal.sealOf(leased) + "x"));
}

}  // namespace
}  // namespace palpate
