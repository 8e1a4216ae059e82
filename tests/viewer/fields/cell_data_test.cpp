#include "viewer/fields/cell_data.hpp"

#include <gtest/gtest.h>

#include "tests/support/points_in_ball.hpp"
#include "tests/support/sample_dataset.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using test::radius;

std::int32_t slotAt(const CellTree& tree, const LatticePoint& point) {
  for (std::size_t s = 0; s < tree.slots().size(); ++s)
    if (tree.slots()[s].point == point) return static_cast<std::int32_t>(s);
  ADD_FAILURE() << "no slot at " << point[0] << ' ' << point[1] << ' ' << point[2];
  return 0;
}

std::vector<Equilibrium> equilibriaOf(const CellTree& tree, const SpaceTable& space,
                                      const std::vector<LatticeEdge>& inconsistent = {}) {
  LocalFits fits(space.lattice.unit());
  return slotEquilibria(tree, space, ghostPolynomials(tree, space, inconsistent, fits));
}

void expectGhostsLike(const test::AnalyticEnergy& energy, const SpaceTable& space,
                      double tolerance) {
  const CellTree tree(space);
  const std::vector<Equilibrium> equilibria = equilibriaOf(tree, space);
  int ghosts = 0;
  for (std::size_t s = 0; s < equilibria.size(); ++s) {
    if (tree.slots()[s].kind != SlotKind::ghost) continue;
    ++ghosts;
    const Vector3d p = tree.displacement(static_cast<std::int32_t>(s));
    EXPECT_LE((equilibria[s].force + energy.gradient(p)).norm(),
              tolerance * energy.gradient(p).norm());
    EXPECT_LE((equilibria[s].stiffness + energy.hessian(p)).norm(),
              tolerance * energy.hessian(p).norm());
  }
  EXPECT_GT(ghosts, 10);
}

TEST(SlotEquilibria, ContinueCubicEnergiesToTheRimAndIntoHoles) {
  const test::PolynomialEnergy cubic(3, radius);
  SpaceTable space = solvedSpace(Lattice(radius, 0.005), cubic);
  for (const LatticePoint& hole :
       {LatticePoint{0, 0, 0}, LatticePoint{1, 0, 0}, LatticePoint{1, 1, 1}}) {
    PointRecord& point = space.points[*space.lattice.indexOf(hole)];
    point.tag = Tag::failed;
    point.equilibrium.force.setConstant(1e9);  // must not be read
  }
  expectGhostsLike(cubic, space, 1e-7);
}

TEST(SlotEquilibria, ContinueSmoothEnergiesToTheRim) {
  const test::StiffeningEnergy energy;
  expectGhostsLike(energy, solvedSpace(Lattice(radius, 0.0025), energy), 0.05);
}

TEST(SlotEquilibria, ContinueALonePointByItsStiffness) {
  SpaceTable space = solvedSpace(Lattice(radius, 0.01), test::StiffeningEnergy());
  for (std::int32_t n = 1; n < space.lattice.size(); ++n) space.points[n].tag = Tag::failed;
  const CellTree tree(space);
  const Equilibrium& origin = space.points[0].equilibrium;
  const std::vector<Equilibrium> equilibria = equilibriaOf(tree, space);
  const std::int32_t far = slotAt(tree, {2, 0, 0});
  EXPECT_LE((equilibria[far].force - origin.force - origin.stiffness * Vector3d(0.02, 0, 0)).norm(),
            1e-9);
}

TEST(SlotEquilibria, DoNotMixBranchesInAGhost) {
  const test::StiffeningEnergy energy;
  SpaceTable space = solvedSpace(Lattice(radius, 0.01), energy);
  std::vector<LatticeEdge> inconsistent;
  const std::int32_t ghost_neighbour = *space.lattice.indexOf({1, 1, 1});
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    if (n == ghost_neighbour) continue;
    space.points[n].equilibrium.force += Vector3d(100, 0, 0);
    inconsistent.push_back({std::min(n, ghost_neighbour), std::max(n, ghost_neighbour)});
  }
  std::sort(inconsistent.begin(), inconsistent.end());
  const CellTree tree(space);
  const std::int32_t corner = slotAt(tree, {2, 2, 2});
  const Vector3d force = equilibriaOf(tree, space, inconsistent)[corner].force;
  EXPECT_LE((force + energy.gradient(tree.displacement(corner))).norm(), 1);
}

TEST(SlotEquilibria, StayBoundedWhereDataDisagree) {
  SpaceTable space = solvedSpace(Lattice(radius, 0.005), test::StiffeningEnergy());
  for (PointRecord& point : space.points)
    if (point.parent % 3 == 0) point.equilibrium.stiffness *= -20;
  double largest = 0;
  for (const PointRecord& point : space.points)
    largest = std::max(largest, point.equilibrium.force.norm());
  const CellTree tree(space);
  for (const Equilibrium& e : equilibriaOf(tree, space)) EXPECT_LT(e.force.norm(), 100 * largest);
}

TEST(SlotCoverage, IsOneAtSolvedSlotsWithoutInconsistentEdges) {
  Lattice lattice(radius, 0.01, 1024);
  lattice.add({512, 512, 512});
  SpaceTable space = solvedSpace(lattice, test::StiffeningEnergy());
  space.splits = {{{0, 0, 0}, 0}};
  space.points[*lattice.indexOf({1024, 0, 0})].tag = Tag::failed;
  const CellTree tree(space);
  const std::int32_t a = *lattice.indexOf({0, 0, 0}), b = *lattice.indexOf({0, 1024, 0});
  const std::vector<double> coverage = slotCoverage(tree, {{std::min(a, b), std::max(a, b)}});
  EXPECT_EQ(coverage[slotAt(tree, {1024, 1024, 0})], 1);
  EXPECT_EQ(coverage[slotAt(tree, {0, 0, 0})], 0);
  EXPECT_EQ(coverage[slotAt(tree, {1024, 0, 0})], 0);
  EXPECT_EQ(coverage[slotAt(tree, {1024, 512, 0})], 0.5);
  EXPECT_EQ(coverage[slotAt(tree, {512, 512, 512})], 1);
}

}  // namespace
}  // namespace palpate
