#include "viewer/report/held_out.hpp"

#include <gtest/gtest.h>

#include "tests/support/sample_dataset.hpp"
#include "viewer/report/compared_lattice.hpp"

namespace palpate {
namespace {

SpaceTable fineSpace() { return test::solvedSpace(Lattice(0.06, 0.01), test::StiffeningEnergy()); }

TEST(HeldOutSolutions, AreTheProbesWithinMaxForceOffTheLattices) {
  SpaceTable dense = fineSpace();
  const auto probe = [](double x, Tag tag, double force) {
    Probe made;
    made.displacement = {x, 0, 0};
    made.record.tag = tag;
    made.record.equilibrium.force = {force, 0, 0};
    return made;
  };
  dense.probes = {probe(0.013, Tag::expandable, 1), probe(0.011, Tag::failed, 2),
                  probe(0.01, Tag::expandable, 3), probe(0.017, Tag::terminating, 4)};
  SpaceTable coarse = thinned(dense, 2);
  coarse.probes.push_back(probe(0.033, Tag::expandable, 5));
  const std::vector<HeldOutSolution> solutions = usableProbes({&dense, &coarse});
  ASSERT_EQ(solutions.size(), 2U);
  EXPECT_EQ(solutions[0].force.x(), 1);
  EXPECT_EQ(solutions[1].force.x(), 5);
}

TEST(HeldOutSolutions, WithoutProbesAreThePointsLeftOutOfCoarserLattices) {
  SpaceTable dense = fineSpace();
  dense.points[*dense.lattice.indexOf({1, 0, 0})].tag = Tag::failed;
  const SpaceTable second = thinned(dense, 2), third = thinned(dense, 3);
  const std::vector<HeldOutSolution> solutions = leftOutPoints(dense, {&second, &third});
  // 925 points, 123 and 33 of them in the two lattices, 7 in both, one failed
  EXPECT_EQ(solutions.size(), 925U - 123U - 33U + 7U - 1U);
}

}  // namespace
}  // namespace palpate
