#include <gtest/gtest.h>

#include "common/space/space_table.hpp"

namespace palpate {
namespace {

TEST(InterpolatedPoints, LeaveOutCrushedNeighboursWhenOnlyRestIsExpandable) {
  SpaceTable space;
  space.lattice = Lattice(0.008, 0.008);
  space.points.resize(static_cast<std::size_t>(space.lattice.size()));
  ASSERT_GE(space.points.size(), 4u);
  for (PointRecord& point : space.points) point.tag = Tag::failed;
  space.points[0].tag = Tag::expandable;
  const double forces[] = {0, 14, 17, 9e14};
  for (std::size_t n = 1; n < 4; ++n) {
    space.points[n].tag = Tag::terminating;
    space.points[n].equilibrium.force.x() = forces[n];
  }
  const std::vector<bool> used = interpolatedPoints(space);
  EXPECT_TRUE(used[0] && used[1] && used[2]);
  EXPECT_FALSE(used[3]);
}

}  // namespace
}  // namespace palpate
