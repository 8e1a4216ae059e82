#include "common/interpolation/branch_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/sample_dataset.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using test::PolynomialEnergy;
using test::solvedSpace;
using test::StiffeningEnergy;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double radius = 0.02;

/// Moves every point with x > 0 to another branch, with `force` more along z and, at z = 0,
/// `energy` less.
SpaceTable withJump(SpaceTable space, double force, double energy) {
  for (std::int32_t n = 0; n < space.lattice.size(); ++n)
    if (space.lattice.point(n)[0] > 0) {
      space.points[n].equilibrium.force.z() += force;
      space.points[n].equilibrium.energy -= energy + force * space.lattice.displacement(n).z();
    }
  return space;
}

/// The edges of uniform cells from the plane x = 0 towards larger x.
std::vector<LatticeEdge> edgesAcross(const Lattice& lattice) {
  std::vector<LatticeEdge> edges;
  for (std::int32_t n = 0; n < lattice.uniformSize(); ++n) {
    LatticePoint upper = lattice.point(n);
    if (upper[0] != 0) continue;
    upper[0] += lattice.divisions();
    if (const auto other = lattice.indexOf(upper))
      edges.push_back({std::min(n, *other), std::max(n, *other)});
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

TEST(BranchCheck, FindsNothingOnSmoothBranchesHoweverCoarse) {
  for (const double spacing : {0.02, 0.01, 0.0025}) {
    EXPECT_THAT(inconsistentEdges(solvedSpace(Lattice(radius, spacing), StiffeningEnergy())),
                IsEmpty());
    for (const int degree : {2, 3, 4, 6})
      EXPECT_THAT(inconsistentEdges(
                      solvedSpace(Lattice(radius, spacing), PolynomialEnergy(degree, radius))),
                  IsEmpty())
          << degree << " at " << spacing;
  }
}

TEST(BranchCheck, IsExactForPolynomialsUpToTheOrderOfItsRules) {
  const PolynomialEnergy quartic(4, radius);
  const SpaceTable space = solvedSpace(Lattice(radius, 0.005), quartic);
  const auto other = *space.lattice.indexOf({1, 1, 0});
  const EdgeCheck check = checkEdge(space.points[0].equilibrium, space.points[other].equilibrium,
                                    space.lattice.displacement(other), 1);
  EXPECT_LT(check.energy_mismatch, 1e-12 * check.change) << "exact up to the fourth degree";
  EXPECT_GT(check.force_mismatch, 1e-6 * check.change);
  EXPECT_LT(check.force_mismatch, check.bend);
}

TEST(BranchCheck, FindsEveryEdgeAcrossAJumpOfForceAndNoOther) {
  const Lattice lattice(radius, 0.005);
  const SpaceTable smooth = solvedSpace(lattice, StiffeningEnergy());
  for (const double jump : {0.2, 2.0, -20.0})
    EXPECT_EQ(inconsistentEdges(withJump(smooth, jump, 0)), edgesAcross(lattice)) << jump;
}

/// The same body of a material that is 500 times softer.
TEST(BranchCheck, FindsTheSameJumpsInABodyWithTinyForces) {
  const Lattice lattice(radius, 0.005);
  SpaceTable soft = withJump(solvedSpace(lattice, StiffeningEnergy()), 0.2, 0);
  for (PointRecord& point : soft.points) {
    point.equilibrium.energy /= 500;
    point.equilibrium.force /= 500;
    point.equilibrium.stiffness /= 500;
  }
  EXPECT_EQ(inconsistentEdges(soft), edgesAcross(lattice));
}

TEST(BranchCheck, FindsBranchesThatDifferOnlyInEnergy) {
  const Lattice lattice(radius, 0.005);
  EXPECT_EQ(inconsistentEdges(withJump(solvedSpace(lattice, StiffeningEnergy()), 0, 1e-3)),
            edgesAcross(lattice));
}

TEST(BranchCheck, SuspectsInconsistentEdgesAndEdgesThatAreTooLong) {
  const SpaceTable jump = withJump(solvedSpace(Lattice(radius, 0.005), StiffeningEnergy()), 2, 0);
  EXPECT_EQ(suspectEdges(jump), inconsistentEdges(jump));

  const PolynomialEnergy wild(6, 0.004);
  const SpaceTable coarse = solvedSpace(Lattice(radius, 0.01), wild);
  EXPECT_GT(suspectEdges(coarse).size(), inconsistentEdges(coarse).size());
}

TEST(BranchCheck, IgnoresUnsolvedPoints) {
  SpaceTable space = withJump(solvedSpace(Lattice(radius, 0.01), StiffeningEnergy()), 2, 0);
  for (std::int32_t n = 1; n < space.lattice.size(); ++n) space.points[n].tag = Tag::failed;
  EXPECT_THAT(inconsistentEdges(space), IsEmpty());
  const std::int32_t one = *space.lattice.indexOf({1, 0, 0});
  space.points[one].tag = Tag::terminating;
  EXPECT_THAT(inconsistentEdges(space), ElementsAre(LatticeEdge{0, one}));
  EXPECT_THAT(inconsistentEdges(SpaceTable{}), IsEmpty());
}

TEST(BranchCheck, TestsTheEdgesOfTheLeavesOfARefinedLattice) {
  Lattice lattice(radius, 0.01, 1024);
  const LatticeCell split{{0, 0, 0}, 0};
  for (std::int32_t i = 0; i <= 2; ++i)
    for (std::int32_t j = 0; j <= 2; ++j)
      for (std::int32_t k = 0; k <= 2; ++k)
        if (const LatticePoint p{512 * i, 512 * j, 512 * k}; !lattice.indexOf(p)) lattice.add(p);
  SpaceTable space = withJump(solvedSpace(lattice, StiffeningEnergy()), 2, 0);
  space.splits = {split};
  std::vector<LatticeEdge> expected = edgesAcross(lattice);  // whole edges, because coarse cells
                                                             // contain them
  for (const std::int32_t j : {0, 512, 1024})
    for (const std::int32_t k : {0, 512, 1024})
      expected.push_back({*lattice.indexOf({0, j, k}), *lattice.indexOf({512, j, k})});
  for (LatticeEdge& edge : expected)
    if (edge.a > edge.b) std::swap(edge.a, edge.b);
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(inconsistentEdges(space), expected);
}

}  // namespace
}  // namespace palpate
