#include <gtest/gtest.h>

#include "tests/support/random_loops.hpp"
#include "tests/support/sample_dataset.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

TEST(RandomLoop, IsClosedAndStaysInTheBall) {
  std::mt19937 random(20);
  for (int n = 0; n < 50; ++n) {
    const test::RandomLoop loop(random, 0.02);
    EXPECT_LT((loop.at(0) - loop.at(1)).norm(), 1e-15);
    for (int i = 0; i < 200; ++i) {
      const double t = (i + 0.5) / 200;
      EXPECT_LT(loop.at(t).norm(), 0.02);
      EXPECT_LT((loop.slope(t) - (loop.at(t + 1e-7) - loop.at(t - 1e-7)) / 2e-7).norm(), 1e-6);
    }
  }
}

TEST(ForceField, PotentialCreatesNoEnergyOnRandomLoops) {
  const SpaceTable space = test::solvedSpace(Lattice(0.02, 0.005), test::StiffeningEnergy());
  const auto potential = makeForceField("potential", space),
             trilinear = makeForceField("trilinear", space);
  std::mt19937 random(20);
  double net = 0, exchanged = 0, trilinear_net = 0, trilinear_exchanged = 0;
  for (int n = 0; n < 200; ++n) {
    const test::RandomLoop loop(random, 0.02);
    const test::LoopEnergy mine = loopEnergy(*potential, loop),
                           theirs = loopEnergy(*trilinear, loop);
    EXPECT_LT(mine.error, 1e-7 * mine.exchanged);
    net += std::abs(mine.net);
    exchanged += mine.exchanged;
    trilinear_net += std::abs(theirs.net);
    trilinear_exchanged += theirs.exchanged;
  }
  EXPECT_LT(net, 1e-6 * exchanged);
  EXPECT_GT(trilinear_net, 1e-4 * trilinear_exchanged);  // so this test can detect energy
}

}  // namespace
}  // namespace palpate
