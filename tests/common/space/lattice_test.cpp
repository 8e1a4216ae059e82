#include "common/space/lattice.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

using test::expectBadInput;

TEST(Lattice, HasThePointCountsOfThePaperAndTheOrigin) {
  EXPECT_EQ(Lattice(0.1, 0.02).size(), 515);
  EXPECT_EQ(Lattice(0.1, 0.1 / 7).size(), 1419);
  EXPECT_EQ(Lattice(0.1, 0.01).size(), 4169);
  EXPECT_EQ(Lattice(0.1, 0.1 / 15).size(), 14147);
}

TEST(Lattice, TreatsARoundedSpacingAsTheExactFraction) {
  const Lattice lattice(0.1, 0.0143);
  EXPECT_EQ(lattice.size(), 1419);
  EXPECT_DOUBLE_EQ(lattice.spacing(), 0.1 / 7);
  EXPECT_EQ(Lattice(0.1, 0.006667).size(), 14147);
}

TEST(Lattice, KeepsASpacingThatDoesNotDivideTheRadius) {
  const Lattice lattice(0.1, 0.03);
  EXPECT_EQ(lattice.spacing(), 0.03);
  for (std::int32_t n = 0; n < lattice.size(); ++n) EXPECT_LE(lattice.displacement(n).norm(), 0.1);
  EXPECT_TRUE(lattice.indexOf({3, 1, 1}).has_value());
  EXPECT_FALSE(lattice.indexOf({3, 2, 0}).has_value());
}

TEST(Lattice, NumbersPointsOutwardFromTheOrigin) {
  const Lattice lattice(0.1, 0.02);
  EXPECT_EQ(lattice.point(0), (LatticePoint{0, 0, 0}));
  EXPECT_EQ(lattice.point(1), (LatticePoint{-1, 0, 0}));
  for (std::int32_t n = 1; n < lattice.size(); ++n)
    EXPECT_LT(std::pair(squaredNorm(lattice.point(n - 1)), lattice.point(n - 1)),
              std::pair(squaredNorm(lattice.point(n)), lattice.point(n)));
}

TEST(Lattice, FindsEveryPointByItsCoordinatesAndNoneOutside) {
  const Lattice lattice(0.1, 0.02);
  for (std::int32_t n = 0; n < lattice.size(); ++n) EXPECT_EQ(lattice.indexOf(lattice.point(n)), n);
  for (const LatticePoint& outside :
       {LatticePoint{6, 0, 0}, {4, 4, 0}, {0, 0, -6}, {1 << 30, 0, 0}})
    EXPECT_FALSE(lattice.indexOf(outside).has_value());
}

TEST(Lattice, ListsTheClosestNeighboursFirst) {
  const Lattice lattice(0.1, 0.02);
  const Neighbours neighbours = lattice.neighbours(*lattice.indexOf({2, 0, 0}));
  EXPECT_EQ(neighbours.size(), 26);
  EXPECT_EQ(lattice.point(neighbours[0]), (LatticePoint{1, 0, 0}));
  EXPECT_EQ(lattice.point(neighbours[25]), (LatticePoint{3, 1, 1}));
  EXPECT_EQ(std::set<std::int32_t>(neighbours.begin(), neighbours.end()).size(), 26u);
}

TEST(Lattice, LeavesOutNeighboursBeyondTheBall) {
  const Lattice lattice(0.1, 0.02);
  for (const std::int32_t n : lattice.neighbours(*lattice.indexOf({5, 0, 0})))
    EXPECT_LE(squaredNorm(lattice.point(n)), 25);
  EXPECT_EQ(lattice.neighbours(*lattice.indexOf({5, 0, 0})).size(), 9);
}

TEST(Lattice, NeighbourhoodIsMutual) {
  const Lattice lattice(0.1, 0.03);
  for (std::int32_t n = 0; n < lattice.size(); ++n)
    for (const std::int32_t m : lattice.neighbours(n))
      EXPECT_THAT(lattice.neighbours(m), ::testing::Contains(n));
}

TEST(Lattice, RefusesInvalidLattices) {
  expectBadInput([] { Lattice(0.1, 0); }, {"workspace.spacing", "greater than 0"});
  expectBadInput([] { Lattice(0.1, -1); }, {"workspace.spacing", "greater than 0"});
  expectBadInput([] { Lattice(0.01, 0.02); }, {"workspace.radius", "smaller"});
  expectBadInput([] { Lattice(1, 0.001); }, {"lattice points", "larger spacing"});
  expectBadInput([] { Lattice(std::numeric_limits<double>::infinity(), 0.1); },
                 {"workspace.radius"});
}

/// The half below the plane z = 0.
const PushedPart lower_half = {Eigen::Vector3d::UnitZ(), 0};

TEST(Lattice, PartOfTheBallHasItsPointsAndTheOrigin) {
  const Lattice whole(0.03, 0.01), half(0.03, 0.01, 1, lower_half);
  EXPECT_EQ(whole.size(), 123);
  EXPECT_EQ(half.size(), (123 - 29) / 2 + 29) << "points in the plane belong to it";
  EXPECT_EQ(half.point(0), (LatticePoint{0, 0, 0}));
  for (std::int32_t n = 0; n < half.size(); ++n) {
    EXPECT_LE(half.point(n)[2], 0);
    EXPECT_EQ(half.indexOf(half.point(n)), n);
  }
  EXPECT_EQ(half.indexOf({0, 0, 1}), std::nullopt);
  EXPECT_EQ(half.uniformSize(), half.size());
}

TEST(Lattice, PartOfTheBallHasOnlyNeighboursInside) {
  const Lattice half(0.03, 0.01, 1, lower_half);
  EXPECT_EQ(half.neighbours(0).size(), 17);
}

TEST(Lattice, PartOfTheBallIsAsDeepAsTheBallAndAsWideAsGiven) {
  const PushedPart narrow = {Eigen::Vector3d::UnitZ(), 0, 0.01};
  const Lattice lattice(0.03, 0.01, 1, narrow);
  EXPECT_TRUE(lattice.indexOf({0, 0, -3}));
  EXPECT_TRUE(lattice.indexOf({1, 1, -2}))
      << "1.4 cm sideways; half a spacing more would be allowed";
  EXPECT_FALSE(lattice.indexOf({2, 0, 0}));
  EXPECT_FALSE(lattice.indexOf({2, 0, -2}));
}

TEST(Lattice, PartOfTheBallPullsAsFarAsGiven) {
  const PushedPart wide = {Eigen::Vector3d::UnitZ(), 0.8};
  const Lattice lattice(0.03, 0.01, 1, wide);
  EXPECT_TRUE(lattice.indexOf({1, 0, 1}));
  EXPECT_FALSE(lattice.indexOf({0, 0, 3})) << "3 cm up; only 2.4 cm and half a spacing are allowed";
  EXPECT_EQ(Lattice(0.03, 0.01, 1, PushedPart{}).size(), 123);
}

}  // namespace
}  // namespace palpate
