#include "viewer/export/point_blend.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/viewer/fields/uneven_spaces.hpp"
#include "viewer/fields/pressure_field.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using test::holedSpace;
using test::pointsInBall;
using test::refinedSpace;

TEST(PointBlend, IsTheConfigurationAloneInEverySolvedPoint) {
  const SpaceTable space = holedSpace(0.005);
  const PointBlend blend(space);
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    if (!isSolved(space.points[at(n)].tag)) continue;
    const auto shares = blend.sharesAt(space.lattice.displacement(n));
    ASSERT_EQ(shares.size(), 1U) << n;
    EXPECT_EQ(shares[0].point, n);
    EXPECT_EQ(shares[0].factor, 1.0);
  }
}

/// Of numbers that points have, it makes what the field of pressures, which is seen, makes of them:
/// in holes, on finer leaves, at the rim and beyond it.
TEST(PointBlend, InterpolatesAsWhatIsSeen) {
  for (const SpaceTable& space : {holedSpace(0.005), refinedSpace(0.005)}) {
    std::vector<float> values;
    for (std::int32_t n = 0; n < space.lattice.size(); ++n)
      values.push_back(isSolved(space.points[at(n)].tag) ? static_cast<float>(std::sin(7.0 * n))
                                                         : std::numeric_limits<float>::quiet_NaN());
    const PressureField seen(space, values);
    const PointBlend blend(space);
    std::vector<Vector3d> places = pointsInBall(test::radius);
    places.emplace_back(1, -2, 0.5);
    places.push_back(Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
    for (const Vector3d& p : places) {
      double sum = 0, whole = 0;
      std::int32_t last = -1;
      for (const PointShare& share : blend.sharesAt(p)) {
        EXPECT_GT(share.point, last) << "in ascending order, each once";
        last = share.point;
        sum += share.factor * values[at(share.point)];
        whole += share.factor;
      }
      std::array<float, 1> expected = {0};
      seen.add(p, 1, expected);
      EXPECT_NEAR(sum, expected[0], 2e-6);
      EXPECT_NEAR(whole, 1, 1e-12);
    }
  }
}

}  // namespace
}  // namespace palpate
