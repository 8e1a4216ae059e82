#include "viewer/export/touch_way.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "tests/support/expect_error.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/support/sample_dataset.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using test::expectBadInput;
using Words = std::vector<std::string>;

constexpr double radius = 0.02;

std::vector<TouchInput> touchesOf(const Words& displacement, int steps,
                                  const std::string& lines = "", const Words& at = {}) {
  std::istringstream input(lines);
  return touchWay(at, displacement, steps, input, radius);
}

TEST(TouchWay, GoesStraightFromRestToTheDisplacement) {
  const auto touches = touchesOf({"0.003", "0", "-0.004"}, 5);
  ASSERT_EQ(touches.size(), 6U);
  EXPECT_TRUE(touches.front().displacement.isZero(0));
  EXPECT_NEAR((touches[2].displacement - Vector3d(0.0012, 0, -0.0016)).norm(), 0, 1e-15);
  EXPECT_EQ(touches.back().displacement, Vector3d(0.003, 0, -0.004));
}

TEST(TouchWay, HasTheLengthOfTheToolsMotion) {
  const test::TemporaryDirectory directory;
  test::SampleDataset().seal(directory / "sample.h5");
  const Dataset dataset(directory / "sample.h5");
  const ForceAnswers answers(dataset, "tip", false, "potential");
  const auto way =
      followWay(touchesOf({"-"}, 0, "0.001 0 0\n0.001 0 0.002\n# nothing\n0.001 0 0\n"), answers);
  ASSERT_EQ(way.size(), 3U);
  EXPECT_EQ(way[0].way, 0) << "begins where the first is";
  EXPECT_DOUBLE_EQ(way[1].way, 0.002);
  EXPECT_DOUBLE_EQ(way[2].way, 0.004);
  EXPECT_EQ(way[1].answer.sample.force, answers.answer(way[1].touch).sample.force);
}

/// The second place of the path lies above the body.
TEST(TouchWay, ForAFingerJoinsPointsOfTheSurface) {
  const test::TemporaryDirectory directory;
  test::FingerBody().seal(directory / "finger.h5");
  const Dataset dataset(directory / "finger.h5");
  const ForceAnswers answers(dataset, "top", true, "potential");
  const auto way = followWay(
      touchesOf({"-"}, 0, "0.05 0.05 0.1 0 0 -0.001\n0.053 0.05 0.13 0 0 -0.005\n", {"-"}),
      answers);
  ASSERT_EQ(way.size(), 2U);
  EXPECT_EQ(way[1].touch.at, Vector3d(0.053, 0.05, 0.13));
  EXPECT_NEAR(way[1].way, 0.005, 1e-12);
}

TEST(TouchWay, HasSteps) {
  for (const int steps : {0, -3, most_steps + 1})
    expectBadInput(
        [&] {
          touchesOf({"0.01", "0", "0"}, steps);
        },
        {"--steps " + std::to_string(steps), "1 to 100000"});
  expectBadInput([&] { touchesOf({"-"}, 4, "0 0 0\n"); }, {"--steps 4", "--displacement -"});
  expectBadInput([&] { touchesOf({"-"}, 0, "# nothing\n"); },
                 {"standard input", "no displacement"});
  expectBadInput([&] { touchesOf({"-"}, 0, "0 0 0\n0 0\n"); }, {"standard input, line 2"});
}

}  // namespace
}  // namespace palpate
