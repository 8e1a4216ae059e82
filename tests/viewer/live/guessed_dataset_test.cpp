#include "viewer/live/guessed_dataset.hpp"

#include <gtest/gtest.h>

#include "common/dataset/dataset.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/problems.hpp"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate {
namespace {

TEST(GuessedDataset, CanBeTouchedEverywhereOnTheAreaOfAFinger) {
  const test::FingerBody body(4);
  const GuessedDataset guess(body.problem);
  const Dataset dataset(guess.file());
  EXPECT_TRUE(dataset.probePlaces().empty()) << "a guess is not measured";
  const HapticModel model(dataset);
  ASSERT_EQ(model.surface().areas().size(), 1u);
  const AreaSample pressed = model.area(0).evaluate({0.05, 0.05, 0.1}, {0, 0, -0.005});
  EXPECT_GT(pressed.force[2], 0.1);
  EXPECT_LT(pressed.force[2], 5);
}

TEST(GuessedDataset, IsRemovedWithItsFolder) {
  std::filesystem::path folder;
  {
    const GuessedDataset guess(test::FingerBody().problem);
    folder = guess.file().parent_path();
    EXPECT_TRUE(std::filesystem::exists(guess.file()));
  }
  EXPECT_FALSE(std::filesystem::exists(folder));
}

TEST(GuessedDataset, NeedsAFinger) {
  test::expectBadInput(
      [] {
        GuessedDataset(test::clampedProblem(test::mooneyRivlinScene(), test::cubeMesh(0.1, 2),
                                            Eigen::Vector3d(0.1, 0.05, 0.05)));
      },
      {"tip", "finger"});
}

}  // namespace
}  // namespace palpate
