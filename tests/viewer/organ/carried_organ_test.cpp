#include "viewer/organ/carried_organ.hpp"

#include <gtest/gtest.h>

#include "tests/support/expect_error.hpp"
#include "tests/support/small_organ.hpp"

namespace palpate {
namespace {

TEST(CarriedOrgan, RoundTripsUnchanged) {
  for (const bool finger : {false, true}) {
    const std::string bytes = encode(test::smallOrgan(finger));
    EXPECT_EQ(encode(decode(bytes)), bytes);
  }
}

/// Regression: a deep and narrow lattice was treated as one with missing points.
TEST(CarriedOrgan, AcceptsADeepAndNarrowLattice) {
  const std::string bytes =
      encode(test::smallOrgan(true, 0.4, {Eigen::Vector3d::UnitZ(), -0.25, 0.02}));
  EXPECT_EQ(encode(decode(bytes)), bytes);
}

/// Regression: in single precision, forces on a stiff organ were more than 1e-6 N off.
TEST(CarriedOrgan, KeepsFingerDataBeyondSinglePrecision) {
  CarriedOrgan organ = test::smallOrgan(true);
  Equilibrium& exact = organ.spaces[1].points[4].equilibrium;
  exact.energy = M_PI;
  exact.drive = {-M_PI, 1e-9 * M_PI, 0};
  exact.stiffness_by_s.setConstant(1e5 * M_E);
  const Equilibrium kept = decode(encode(organ)).spaces[1].points[4].equilibrium;
  EXPECT_EQ(kept.energy, exact.energy);
  EXPECT_EQ(kept.drive.z(), 0);
  EXPECT_NEAR(kept.drive.x() / exact.drive.x(), 1, 1e-11);
  EXPECT_NEAR(kept.drive.y() / exact.drive.y(), 1, 1e-11);
  EXPECT_LT((kept.stiffness_by_s - exact.stiffness_by_s).norm(),
            1e-11 * exact.stiffness_by_s.norm());
}

TEST(CarriedOrgan, IsRefusedIfCutAnywhere) {
  const std::string bytes = encode(test::smallOrgan(true));
  for (std::size_t length = 0; length < bytes.size(); ++length)
    test::expectError(ExitCode::failed, [&] { decode(std::string_view(bytes).substr(0, length)); },
                      {"cut off", "palpate share"});
}

}  // namespace
}  // namespace palpate
