#include "viewer/live/unsolved_dataset.hpp"

#include <gtest/gtest.h>

#include "common/dataset/dataset.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/problems.hpp"
#include "viewer/haptics/contact.hpp"

namespace palpate {
namespace {

TEST(UnsolvedDataset, CanBeTouchedByAGuessEverywhereOnTheAreaOfAFinger) {
  const test::FingerBody body(4);
  const UnsolvedDataset unsolved(body.problem);
  const Dataset dataset(unsolved.file());
  EXPECT_TRUE(dataset.isPartial());
  EXPECT_TRUE(dataset.probePlaces().empty()) << "a guess is not measured";
  const HapticModel model(dataset, {.guess = true});
  ASSERT_EQ(model.surface().areas().size(), 1u);
  const AreaSample pressed = model.area(0).evaluate({0.05, 0.05, 0.1}, {0, 0, -0.005});
  EXPECT_GT(pressed.force[2], 0.1);
  EXPECT_LT(pressed.force[2], 5);
}

TEST(UnsolvedDataset, TheGuessOfASingleSiteIsBoundedByItsForce) {
  Problem problem = test::FingerBody().problem;
  problem.active.resize(1);
  problem.scene.active.resize(1);
  problem.active[0].finger->radius = problem.scene.active[0].radius = 0.06;
  const UnsolvedDataset unsolved(problem);
  const HapticModel model(Dataset(unsolved.file()), {.guess = true});
  const Eigen::Vector3d place = problem.active[0].finger->center, push(0, 0, -0.004);
  Contact contact(model);
  contact.update(place + Eigen::Vector3d(0, 0, 0.001));
  const Touch& touch = contact.update(place + push);
  ASSERT_TRUE(touch.touching);
  EXPECT_GE(touch.error_bound, touch.force.norm());
}

TEST(UnsolvedDataset, IsRemovedWithItsFolder) {
  std::filesystem::path folder;
  {
    const UnsolvedDataset unsolved(test::FingerBody().problem);
    folder = unsolved.file().parent_path();
    EXPECT_TRUE(std::filesystem::exists(unsolved.file()));
  }
  EXPECT_FALSE(std::filesystem::exists(folder));
}

TEST(UnsolvedDataset, NeedsAFinger) {
  test::expectBadInput(
      [] {
        UnsolvedDataset(test::clampedProblem(test::mooneyRivlinScene(), test::cubeMesh(0.1, 2),
                                             Eigen::Vector3d(0.1, 0.05, 0.05)));
      },
      {"tip", "finger"});
}

TEST(UnsolvedDataset, NeedsFingersOfOneRadius) {
  Problem problem = test::FingerBody().problem;
  problem.active.back().finger->radius *= 0.9;
  test::expectBadInput([&] { UnsolvedDataset unsolved(problem); }, {problem.scene.name, "radii"});
}

}  // namespace
}  // namespace palpate
