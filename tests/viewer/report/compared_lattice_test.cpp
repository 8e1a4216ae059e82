#include "viewer/report/compared_lattice.hpp"

#include <gtest/gtest.h>

#include "tests/support/expect_error.hpp"
#include "tests/support/sample_dataset.hpp"

namespace palpate {
namespace {

using test::StiffeningEnergy;

SpaceTable denseSpace(std::int32_t divisions = 1) {
  return test::solvedSpace(Lattice(0.06, 0.01, divisions), StiffeningEnergy());
}

TEST(ThinnedSpace, IsTheSpaceOfAWiderSpacing) {
  const SpaceTable dense = denseSpace();
  for (const std::int32_t factor : {2, 3, 4, 6}) {
    const SpaceTable coarse = thinned(dense, factor);
    const SpaceTable expected = test::solvedSpace(Lattice(0.06, factor * 0.01), StiffeningEnergy());
    ASSERT_EQ(coarse.points.size(), expected.points.size()) << factor;
    ASSERT_EQ(coarse.lattice.size(), expected.lattice.size()) << factor;
    for (std::int32_t n = 0; n < coarse.lattice.size(); ++n) {
      EXPECT_EQ(coarse.lattice.point(n), expected.lattice.point(n));
      EXPECT_LT((coarse.points[n].equilibrium.force - expected.points[n].equilibrium.force).norm(),
                1e-12);
    }
  }
}

TEST(ThinnedSpace, KeepsFailuresAndAttemptsOfItsPointsOnly) {
  SpaceTable dense = denseSpace();
  const std::int32_t kept = *dense.lattice.indexOf({2, 0, 0}),
                     lost = *dense.lattice.indexOf({1, 0, 0});
  dense.points[kept].tag = Tag::failed;
  dense.attempts = {{kept, 0, {}}, {kept, lost, {}}, {lost, 0, {}}};
  dense.probes.resize(3);
  const SpaceTable coarse = thinned(dense, 2);
  ASSERT_EQ(coarse.attempts.size(), 1U);
  EXPECT_EQ(coarse.lattice.point(coarse.attempts[0].target), (LatticePoint{1, 0, 0}));
  EXPECT_EQ(coarse.points[coarse.attempts[0].target].tag, Tag::failed);
  EXPECT_EQ(coarse.probes.size(), 3U);
  for (const PointRecord& point : coarse.points) {
    EXPECT_GE(point.parent, 0);
    EXPECT_LT(point.parent, coarse.lattice.size());
  }
}

TEST(ThinnedSpace, StaysWithinItsPartOfTheBall) {
  const PushedPart part = {Eigen::Vector3d::UnitZ(), 0.2};
  const SpaceTable dense = test::solvedSpace(Lattice(0.06, 0.01, 1, part), StiffeningEnergy());
  const SpaceTable coarse = thinned(dense, 2);
  int solved = 0;
  for (std::int32_t n = 0; n < coarse.lattice.size(); ++n) {
    if (isSolved(coarse.points[n].tag))
      ++solved;
    else
      EXPECT_FALSE(part.contains(coarse.lattice.displacement(n)));
  }
  EXPECT_GT(solved, coarse.lattice.size() / 2);
  EXPECT_LT(solved, coarse.lattice.size());
}

TEST(ThinnedSpace, LeavesRefinementOut) {
  SpaceTable dense = denseSpace(1024);
  const std::size_t uniform = dense.points.size();
  dense.lattice.add({512, 512, 512});
  dense.points.push_back(dense.points.front());
  dense.splits = {{{0, 0, 0}, 0}};
  const SpaceTable same = thinned(dense, 1);
  EXPECT_EQ(same.points.size(), uniform);
  EXPECT_TRUE(same.splits.empty());
  EXPECT_EQ(thinned(dense, 3).points.size(), 33U);
}

TEST(ThinnedSpace, RefusesToLeaveTheOriginAlone) {
  const SpaceTable dense = denseSpace();
  EXPECT_TRUE(isThinnable(dense.lattice, 6));
  EXPECT_FALSE(isThinnable(dense.lattice, 7));
  EXPECT_FALSE(isThinnable(dense.lattice, 0));
  test::expectError(ExitCode::failed, [&] { thinned(dense, 7); }, {"tip", "0.06"});
}

}  // namespace
}  // namespace palpate
