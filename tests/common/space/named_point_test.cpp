#include <gtest/gtest.h>

#include <limits>

#include "common/space/lattice.hpp"
#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;

TEST(NamedPoint, IsFoundByItsCoordinatesInSpacings) {
  Lattice lattice(0.02, 0.01, 4);
  lattice.add({2, 0, 1});
  EXPECT_EQ(pointNamed(lattice, {0, 0, 0}), 0);
  for (std::int32_t n = 0; n < lattice.size(); ++n)
    EXPECT_EQ(pointNamed(lattice, lattice.displacement(n) / lattice.spacing()), n);
  EXPECT_EQ(pointNamed(lattice, {0.5, 0, 0.25}), lattice.size() - 1);
}

TEST(NamedPoint, AMissingPointIsRefusedWithTheBounds) {
  const Lattice lattice(0.02, 0.01, 4);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Vector3d& point : {Vector3d(3, 0, 0), Vector3d(0.1, 0, 0), Vector3d(0.5, 0, 0),
                                Vector3d(1e300, 0, 0), Vector3d(nan, 0, 0)})
    test::expectBadInput([&] { pointNamed(lattice, point); },
                         {"is not in the lattice", "i^2 + j^2 + k^2 <= 4", "radius 0.02 m"});
}

}  // namespace
}  // namespace palpate
