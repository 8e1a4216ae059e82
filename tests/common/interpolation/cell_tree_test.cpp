#include "common/interpolation/cell_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/expect_error.hpp"
#include "tests/support/uneven_spaces.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;

constexpr double radius = 0.06, spacing = 0.02;

SpaceTable spaceWithSplits(const std::vector<LatticeCell>& splits) {
  return test::splitSpace(Lattice(radius, spacing, 1024), splits, test::StiffeningEnergy());
}

const std::vector<LatticeCell> two_levels = {{{0, 0, 0}, 0}, {{512, 512, 512}, 1}};

Vector3d inBall(std::mt19937& random) {
  std::uniform_real_distribution<double> coordinate(-radius, radius);
  for (;;) {
    const double x = coordinate(random), y = coordinate(random), z = coordinate(random);
    if (Vector3d(x, y, z).norm() <= radius) return {x, y, z};
  }
}

TEST(CellTree, FindsALeafForEveryDisplacementOfTheBall) {
  const CellTree tree(spaceWithSplits(two_levels));
  std::mt19937 random(5);
  for (int n = 0; n < 5000; ++n) {
    Vector3d p = inBall(random);
    if (n % 3 == 0) p *= radius / p.norm();
    const LeafPlace place = tree.find(p);
    ASSERT_GE(place.leaf, 0) << p.transpose();
    EXPECT_TRUE(place.local.minCoeff() >= 0 && place.local.maxCoeff() <= 1);
    const Vector3d low = tree.displacement(tree.corners(place.leaf)[0]);
    EXPECT_LE((low + tree.edge(place.leaf) * place.local - p).norm(), 2e-9 * radius);
  }
  for (int axis = 0; axis < 3; ++axis)
    for (const double end : {-radius, radius})
      EXPECT_GE(tree.find(end * Vector3d::Unit(axis)).leaf, 0);
}

TEST(CellTree, FindsNoLeafOutsideTheBall) {
  const CellTree tree(spaceWithSplits({}));
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Vector3d& p :
       {Vector3d(0.0601, 0, 0), Vector3d(0.05, 0.05, 0), Vector3d(1e300, 1e300, 0),
        Vector3d(std::nan(""), 0, 0), Vector3d(-infinity, 0, 0)})
    EXPECT_EQ(tree.find(p).leaf, -1);
}

TEST(CellTree, HasOnlyCellsThatReachIntoTheBall) {
  // 23 of the 27 cells of an octant have their nearest corner closer than 3 spacings. Those of (2,
  // 2, 1) and its permutations lie on the sphere, and that of (2, 2, 2) lies outside.
  EXPECT_EQ(CellTree(spaceWithSplits({})).leaves().size(), 184U);
}

TEST(CellTree, TellsSolvedGhostAndHangingCornersApart) {
  SpaceTable space = spaceWithSplits(two_levels);
  space.points[*space.lattice.indexOf({512, 512, 512})].tag = Tag::failed;
  const CellTree tree(space);
  const auto kind = [&](const LatticePoint& point) {
    for (const CellSlot& slot : tree.slots())
      if (slot.point == point) return slot.kind;
    ADD_FAILURE() << "no slot";
    return SlotKind::ghost;
  };
  EXPECT_EQ(kind({1024, 1024, 1024}), SlotKind::solved);
  EXPECT_EQ(kind({512, 512, 512}), SlotKind::ghost) << "failed";
  EXPECT_EQ(kind({3072, 1024, 0}), SlotKind::ghost) << "outside of the ball";
  EXPECT_EQ(kind({512, 512, 0}), SlotKind::hanging)
      << "on a face of an unsplit cell, though solved";
  EXPECT_EQ(kind({768, 768, 768}), SlotKind::solved);
  EXPECT_EQ(kind({768, 768, 512}), SlotKind::hanging) << "on a face of an eighth";
}

TEST(CellTree, TreatsATerminatingPointOfACrushedElementAsFailed) {
  SpaceTable space = test::solvedSpace(Lattice(radius, spacing), test::StiffeningEnergy());
  double largest = 0;
  for (const PointRecord& point : space.points)
    largest = std::max(largest, point.equilibrium.force.norm());
  const std::int32_t strong = *space.lattice.indexOf({2, 0, 0}),
                     crushed = *space.lattice.indexOf({0, 2, 0});
  for (const std::int32_t n : {strong, crushed}) space.points[n].tag = Tag::terminating;
  space.points[strong].equilibrium.force = {2 * largest, 0, 0};
  space.points[crushed].equilibrium.force = {0, 40 * largest, 0};
  const CellTree tree(space);
  const auto kindAt = [&](const LatticePoint& point) {
    return std::find_if(tree.slots().begin(), tree.slots().end(),
                        [&](const CellSlot& slot) { return slot.point == point; })
        ->kind;
  };
  EXPECT_EQ(kindAt({2, 0, 0}), SlotKind::solved);
  EXPECT_EQ(kindAt({0, 2, 0}), SlotKind::ghost);
}

TEST(CellTree, OrdersHangingSlotsSoThatInterpolantsAreContinuous) {
  const SpaceTable space = spaceWithSplits(two_levels);
  const CellTree tree(space);
  std::vector<double> energy(tree.slots().size());
  for (std::size_t s = 0; s < energy.size(); ++s)
    if (tree.slots()[s].kind == SlotKind::solved)
      energy[s] = space.points[tree.slots()[s].number].equilibrium.energy;
  const auto evaluate = [&](std::int32_t leaf, const Vector3d& local) {
    const std::array<double, 8> weights = trilinearWeights(local);
    double sum = 0;
    for (std::size_t c = 0; c < 8; ++c)
      sum += weights[c] * energy[static_cast<std::size_t>(tree.corners(leaf)[c])];
    return sum;
  };
  fillHanging(tree, energy, evaluate);
  std::mt19937 random(9);
  for (int n = 0; n < 3000; ++n) {
    Vector3d p = 0.5 * inBall(random), q;
    const int axis = n % 3;
    p[axis] = 0.005 * std::round(p[axis] / 0.005);
    q = p;
    p[axis] -= 1e-12;
    q[axis] += 1e-12;
    const LeafPlace below = tree.find(p), above = tree.find(q);
    EXPECT_NEAR(evaluate(below.leaf, below.local), evaluate(above.leaf, above.local), 1e-11);
  }
}

TEST(CellTree, RecognisesLeavesWithoutASolvedCorner) {
  SpaceTable space = spaceWithSplits({});
  for (std::int32_t n = 0; n < space.lattice.size(); ++n)
    if (space.lattice.point(n)[0] > 0) space.points[n].tag = Tag::failed;
  const CellTree tree(space);
  EXPECT_TRUE(tree.unsupported(tree.find({0.03, 0.001, 0.001}).leaf));
  EXPECT_FALSE(tree.unsupported(tree.find({0.01, 0.001, 0.001}).leaf));
}

TEST(CellTree, NeedsASolvedPoint) {
  SpaceTable space = spaceWithSplits({});
  for (PointRecord& point : space.points) point = {};
  test::expectError(ExitCode::failed, [&] { const CellTree tree(space); },
                    {"no lattice point was solved"});
}

TEST(NearestInBall, IsFiniteForAnyInput) {
  const double infinity = std::numeric_limits<double>::infinity(), nan = std::nan("");
  EXPECT_EQ(nearestInBall({0.01, 0.02, 0}, radius), Vector3d(0.01, 0.02, 0));
  EXPECT_LE((nearestInBall({3, 4, 0}, 1) - Vector3d(0.6, 0.8, 0)).norm(), 1e-15);
  EXPECT_LE((nearestInBall({3e307, 4e307, 0}, 1) - Vector3d(0.6, 0.8, 0)).norm(), 1e-15);
  EXPECT_EQ(nearestInBall({0, -infinity, 3}, 1), Vector3d(0, -1, 0));
  EXPECT_EQ(nearestInBall({nan, infinity, 3}, 1), Vector3d::Zero());
}

}  // namespace
}  // namespace palpate
