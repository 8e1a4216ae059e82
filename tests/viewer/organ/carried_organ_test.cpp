#include "viewer/organ/carried_organ.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <functional>

#include "tests/support/expect_error.hpp"
#include "tests/support/small_organ.hpp"

namespace palpate {
namespace {

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

/// Expects this fault to be reported for an organ after `change`.
void expectFault(const std::function<void(CarriedOrgan&)>& change,
                 std::initializer_list<std::string> words) {
  CarriedOrgan organ = test::smallOrgan(true);
  change(organ);
  test::expectError(ExitCode::failed, [&] { decode(encode(organ)); }, {"damaged", "palpate share"});
  test::expectError(
      ExitCode::failed, [&] { decode(encode(organ)); }, words);
}

TEST(CarriedOrgan, NamesAnotherVersionAndTheRemedy) {
  test::expectError(ExitCode::failed, [] { decode("palpate-organ-0\n..."); },
                    {"version 0", "reads version 3", "palpate share"});
  for (const char* bytes : {"", "something else", "palpate-organ-", "palpate-organ-no version\n"})
    test::expectError(ExitCode::failed, [&] { decode(bytes); }, {"organ", "palpate share"});
}

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
  for (std::size_t length = 16; length < bytes.size(); ++length)
    test::expectError(ExitCode::failed, [&] { decode(std::string_view(bytes).substr(0, length)); },
                      {"truncated", "palpate share"});
  test::expectError(ExitCode::failed, [&] { decode(bytes + " "); },
                    {"extra bytes", "palpate share"});
}

TEST(CarriedOrgan, RefusesIndicesOutOfRange) {
  expectFault([](auto& organ) { organ.triangles[2][1] = std::ssize(organ.vertices); },
              {"triangle 2", "corner"});
  expectFault([](auto& organ) { organ.triangles[2][1] = -1; }, {"triangle 2", "corner -1"});
  expectFault([](auto& organ) { organ.triangles[2][1] = organ.triangles[2][0]; }, {"twice"});
  expectFault([](auto& organ) { organ.touch_of_triangle[3] = 1; }, {"triangle 3", "part 1"});
  expectFault([](auto& organ) { organ.touches[0].spaces[0] = std::ssize(organ.spaces); },
              {"part 0", "space"});
  expectFault([](auto& organ) { organ.touches[0].spaces.clear(); }, {"part 0", "no space"});
  expectFault([](auto& organ) { organ.touches[0].collocation_points.clear(); },
              {"part 0", "no collocation points"});
  expectFault(
      [](auto& organ) {
        organ.spaces[1].splits = {{{0, 0, 0}, 40}};
      },
      {"space 1", "split cell 0"});
}

TEST(CarriedOrgan, RefusesNumbersThatAreNotFinite) {
  expectFault([](auto& organ) { organ.vertices[2].y() = no_number; }, {"vertex 2"});
  expectFault([](auto& organ) { organ.max_force = 0; }, {"force", "0 N"});
  expectFault([](auto& organ) { organ.touches[0].rest.x() = no_number; }, {"part 0"});
  expectFault([](auto& organ) { organ.touches[0].collocation_points[0].z() = 1e300; },
              {"collocation point"});
  expectFault([](auto& organ) { organ.spaces[1].patch.finger->center.x() = no_number; },
              {"finger"});
  expectFault([](auto& organ) { organ.spaces[1].patch.finger->radius *= 2; },
              {"space 1", "finger"});
  expectFault([](auto& organ) { organ.spaces[1].points[4].equilibrium.force.x() = no_number; },
              {"space 1", "point 4"});
  expectFault([](auto& organ) { organ.spaces[1].points[4].equilibrium.drive.x() = 1e35; },
              {"space 1", "point 4"});
  expectFault([](auto& organ) { organ.shapes.modes[9] = std::numeric_limits<float>::infinity(); },
              {"mode"});
  expectFault([](auto& organ) { organ.shapes.shares[1][3] = 1e9f; }, {"space 1", "shape"});
}

TEST(CarriedOrgan, RefusesUnlikeOrOversizedLatticesOfOneSurface) {
  expectFault([](auto& organ) { organ.spaces[1].lattice = Lattice(0.02, 0.02, 4); }, {"lattice"});
  std::string bytes = encode(test::smallOrgan(true));
  const double radius = 0.02, finer = radius / 100;
  std::string both(2 * sizeof radius, '\0');  // radius and spacing
  std::memcpy(both.data(), &radius, sizeof radius);
  std::memcpy(both.data() + sizeof radius, &radius, sizeof radius);
  const std::size_t place = bytes.find(both);
  ASSERT_NE(place, std::string::npos);
  std::memcpy(bytes.data() + place + sizeof radius, &finer, sizeof finer);
  test::expectError(ExitCode::failed, [&] { decode(bytes); }, {"lattice", "instead of 4188790"});
}

TEST(CarriedOrgan, AChangedByteIsRefusedOrLeavesItTouchable) {
  const std::string whole = encode(test::smallOrgan(true));
  int refused = 0;
  for (std::size_t place = 0; place < whole.size(); ++place) {
    std::string bytes = whole;
    bytes[place] = static_cast<char>(~bytes[place]);
    try {
      EXPECT_EQ(faultOf(decode(bytes)), "");
    } catch (const Error& error) {
      ++refused;
      EXPECT_THAT(error.what(), testing::HasSubstr("organ"));
    }
  }
  EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace palpate
