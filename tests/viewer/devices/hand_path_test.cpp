#include "viewer/devices/hand_path.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using test::expectBadInput;

HandPath zigzag(HandPath::AtEnd at_end = HandPath::AtEnd::stays) {
  return HandPath({{1, {0, 0, 0}, 0},
                   {1.5, {0.01, -0.02, 0}, 2},
                   {1.6, {0.03, -0.03, 0}, 0},
                   {2.6, {0.03, 0.01, 0.05}, 1},
                   {3, {0, 0, 0}, 0}},
                  at_end);
}

TEST(HandPath, GoesThroughItsWaypointsAndHoldsTheirButtons) {
  const HandPath path = zigzag();
  for (const HandWaypoint& waypoint : path.waypoints()) {
    EXPECT_LT((path.at(waypoint.time).position - waypoint.position).norm(), 1e-15);
    EXPECT_EQ(path.at(waypoint.time).buttons, waypoint.buttons);
  }
  EXPECT_EQ(path.at(1.55).buttons, 2U);
}

TEST(HandPath, RestsBeforeAndAfterItsWaypoints) {
  const HandPath path = zigzag();
  EXPECT_EQ(path.at(-5).position, path.waypoints().front().position);
  EXPECT_EQ(path.at(100).position, path.waypoints().back().position);
  EXPECT_EQ(path.at(100).velocity, Eigen::Vector3d::Zero());
}

TEST(HandPath, HasContinuousVelocityThatIsTheDerivativeOfThePosition) {
  const HandPath path = zigzag(HandPath::AtEnd::repeats);
  const double h = 1e-6;
  for (int n = 0; n < 505; ++n) {
    const double t = 0.9 + 0.0101 * n;
    const Eigen::Vector3d slope = (path.at(t + h).position - path.at(t - h).position) / (2 * h);
    EXPECT_LT((path.at(t).velocity - slope).norm(), 2e-5) << t;
    EXPECT_LT((path.at(t + h).velocity - path.at(t - h).velocity).norm(), 1e-4) << t;
  }
}

TEST(HandPath, NeverOvershootsItsWaypoints) {
  const HandPath path = zigzag();
  for (std::size_t i = 1; i < path.waypoints().size(); ++i) {
    const HandWaypoint &a = path.waypoints()[i - 1], &b = path.waypoints()[i];
    for (int k = 0; k <= 100; ++k) {
      const Eigen::Vector3d p = path.at(a.time + (b.time - a.time) * k / 100).position;
      EXPECT_TRUE((p.array() >= a.position.cwiseMin(b.position).array() - 1e-15).all());
      EXPECT_TRUE((p.array() <= a.position.cwiseMax(b.position).array() + 1e-15).all());
    }
  }
}

TEST(HandPath, RepeatsFromItsStart) {
  const HandPath path = zigzag(HandPath::AtEnd::repeats);
  for (int n = 0; n < 20; ++n) {
    const double t = 1.01 + 0.1 * n;
    EXPECT_LT((path.at(t).position - path.at(t + 3 * path.duration()).position).norm(), 1e-14);
  }
}

TEST(HandPath, RefusesInvalidPaths) {
  expectBadInput([] { HandPath({}); }, {"no waypoint"});
  expectBadInput([] { HandPath({{0, {0, 0, 0}}, {0, {1, 0, 0}}}); }, {"increase", "waypoint 2"});
  expectBadInput([] { HandPath({{0, {0, NAN, 0}}}); }, {"not finite"});
  expectBadInput(
      [] {
        HandPath({{0, {0, 0, 0}}, {1, {1, 0, 0}}}, HandPath::AtEnd::repeats);
      },
      {"end where it begins"});
}

class HandPathFile : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) {
    std::ofstream(directory / "hand.txt") << text;
    return directory / "hand.txt";
  }
  test::TemporaryDirectory directory;
};

TEST_F(HandPathFile, IsReadWithCommentsButtonsAndRepeat) {
  const HandPath path =
      readHandPath(write("# a press\n0 0 0 0.1\n0.5 0 0 0.08 3  # down\n\n1 0 0 0.1\nrepeat\n"));
  ASSERT_EQ(path.waypoints().size(), 3U);
  EXPECT_TRUE(path.repeats());
  EXPECT_EQ(path.waypoints()[1].buttons, 3U);
  EXPECT_EQ(path.waypoints()[1].position, Eigen::Vector3d(0, 0, 0.08));
}

TEST_F(HandPathFile, ErrorsNameFileAndLine) {
  expectBadInput([&] { readHandPath(write("0 0 0 0\n# x\n1 0 0\n")); },
                 {"hand.txt:3", "z in metres"});
  expectBadInput([&] { readHandPath(write("0 0 0 0\n1 0 0 nan\n")); },
                 {"hand.txt:2", "not finite"});
  expectBadInput([&] { readHandPath(write("0 0 0 0\n1 0 0 0 -1\n")); }, {"hand.txt:2", "buttons"});
  expectBadInput([&] { readHandPath(write("1 0 0 0\n1 0 0 0\n")); }, {"hand.txt:2", "increase"});
  expectBadInput([&] { readHandPath(write("0 0 0 0\nrepeat\n1 0 0 0\n")); },
                 {"hand.txt:3", "repeat"});
  expectBadInput([&] { readHandPath(directory / "none.txt"); }, {"none.txt"});
  expectBadInput([&] { readHandPath(write("# nothing\n")); }, {"hand.txt", "no waypoint"});
}

}  // namespace
}  // namespace palpate
