#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "common/space/lattice.hpp"

namespace palpate {
namespace {

TEST(LatticeCell, SortsCoarseCellsFirstThenByLowestCorner) {
  const LatticeCell coarse{{4, 0, 0}, 0}, low{{-2, 0, 0}, 1}, high{{0, -2, 0}, 1};
  std::vector<LatticeCell> cells = {high, low, coarse};
  std::sort(cells.begin(), cells.end(), coarserFirst);
  EXPECT_THAT(cells, ::testing::ElementsAre(coarse, low, high));
  EXPECT_TRUE(isSplit(cells, low));
  EXPECT_FALSE(isSplit(cells, {{-2, 0, 0}, 2}));
}

TEST(LatticeCell, ItsParentLiesAroundIt) {
  EXPECT_EQ(parentOf({{2, -2, 6}, 1}, 4), (LatticeCell{{0, -4, 4}, 0}));
  EXPECT_EQ(parentOf({{-1, 3, 0}, 2}, 4), (LatticeCell{{-2, 2, 0}, 1}));
}

TEST(LatticeCell, CellsThatOnlyTouchTheSphereDoNotReachIntoTheBall) {
  const Lattice lattice(0.1, 0.05, 4);
  EXPECT_TRUE(reachesIntoBall(lattice, {{4, 0, 0}, 0}));
  EXPECT_FALSE(reachesIntoBall(lattice, {{8, 0, 0}, 0})) << "a corner is on the sphere";
  EXPECT_TRUE(reachesIntoBall(lattice, {{4, 4, 4}, 0})) << "its lowest corner is within 1.74 of 2";
  EXPECT_FALSE(reachesIntoBall(lattice, {{6, 6, 6}, 1})) << "its lowest corner is at 2.6 of 2";
}

}  // namespace
}  // namespace palpate
