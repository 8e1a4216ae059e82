#include "viewer/picture/hand_control.hpp"

#include <gtest/gtest.h>

#include "tests/viewer/picture/mouse_run.hpp"

namespace palpate {
namespace {

const HapticModel& handledCube() {
  static const HapticModel model = test::cubeModel();
  return model;
}

/// A person holds the left button and drags the mouse to the right, from `from`, for half a second.
HandControl dragged(test::MouseRun& run, const Eigen::Vector2d& from) {
  HandControl control;
  PersonsInput input;
  input.hand.seconds = 1.0 / 60;
  input.motion.over_view = true;
  input.motion.left = true;
  input.motion.at = from;
  run.act(control, input);
  input.motion.right = 0.001;
  for (int picture = 0; picture < 30; ++picture) {
    input.motion.at.x() += input.motion.right;
    run.act(control, input);
  }
  return control;
}

TEST(HandControl, GivesADragOnTheBodyToTheHandAndLeavesTheCamera) {
  test::MouseRun run(handledCube());
  const Eigen::Vector3d eye = run.camera.position();
  const HandControl control = dragged(run, run.onScreen({0.05, 0.05, 0.1}));
  EXPECT_TRUE(run.state().touch.touching);
  EXPECT_GT(run.state().force.norm(), 0.1);
  EXPECT_EQ((run.camera.position() - eye).norm(), 0);
  EXPECT_FALSE(control.marks().ring) << "a pressed body needs no ring";
  EXPECT_FALSE(control.marks().hint.empty());
}

TEST(HandControl, TurnsTheBodyByADragBesideIt) {
  test::MouseRun run(handledCube());
  const Eigen::Vector3d eye = run.camera.position();
  dragged(run, {0.7, 0.45});
  EXPECT_FALSE(run.touched);
  EXPECT_GT((run.camera.position() - eye).norm(), 0.02);
}

TEST(HandControl, ShowsARingWhereThePersonPointsAtTheBody) {
  test::MouseRun run(handledCube());
  HandControl control;
  PersonsInput input;
  input.motion.over_view = true;
  input.motion.at = run.onScreen({0.05, 0.05, 0.1});
  run.act(control, input);
  ASSERT_TRUE(control.marks().ring);
  EXPECT_NEAR((control.marks().ring->position - Eigen::Vector3d(0.05, 0.05, 0.1)).norm(), 0, 1e-6);
  EXPECT_GT(control.marks().ring_radius, 0);
}

}  // namespace
}  // namespace palpate
