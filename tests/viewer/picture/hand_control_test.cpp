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

class ViewControlTest : public testing::Test {
 protected:
  ViewControlTest() { camera.frame(centre, 0.08, {0.3, 0.2, 1}, Eigen::Vector3d::UnitY(), 1.5); }

  const Eigen::Vector3d centre = {0.1, -0.2, 0.3};
  OrbitCamera camera;
  ViewControl control;
};

TEST_F(ViewControlTest, TurnsByDragsThatBeginInTheView) {
  const Eigen::Vector3d from = camera.position();
  control.apply({.right = 0.2, .left = true}, false, camera);
  control.apply({.wheel = 1}, false, camera);
  EXPECT_EQ(camera.position(), from) << "a drag and a wheel over a panel";
  control.apply({}, false, camera);
  control.apply({.right = 0.2, .over_view = true, .left = true}, false, camera);
  EXPECT_NEAR((camera.position() - centre).norm(), (from - centre).norm(), 1e-12);
  EXPECT_GT((camera.position() - from).norm(), 0.01);
  const Eigen::Vector3d turned = camera.position();
  control.apply({.right = 0.2, .left = true}, false, camera);
  EXPECT_GT((camera.position() - turned).norm(), 0.01) << "the drag goes on over a panel";
}

TEST_F(ViewControlTest, PansByTheMiddleButtonOrShiftAndZoomsByTheWheel) {
  const double distance = camera.distance();
  control.apply({.wheel = 1, .over_view = true}, false, camera);
  EXPECT_LT(camera.distance(), distance);
  control.apply({.right = 0.1, .over_view = true, .left = true, .shift = true}, false, camera);
  EXPECT_NEAR(camera.project(centre).x(), 0.1, 1e-9);
  control.apply({}, false, camera);
  control.apply({.right = 0.1, .over_view = true, .middle = true}, false, camera);
  EXPECT_NEAR(camera.project(centre).x(), 0.2, 1e-9);
}

TEST_F(ViewControlTest, LeavesLeftButtonAndWheelToAPressingHand) {
  const Eigen::Vector3d from = camera.position();
  control.apply({.right = 0.2, .wheel = 3, .over_view = true, .left = true}, true, camera);
  EXPECT_EQ(camera.position(), from);
  control.apply({.right = 0.2, .over_view = true, .right_button = true}, true, camera);
  EXPECT_GT((camera.position() - from).norm(), 0.01) << "the body can be turned while it is held";
}

TEST_F(ViewControlTest, TurnsAndZoomsByKeysToo) {
  const Eigen::Vector3d from = camera.position();
  const double distance = camera.distance();
  control.apply({.turns = {2, 0}}, true, camera);
  EXPECT_GT((camera.position() - from).norm(), 0.01);
  EXPECT_NEAR(camera.distance(), distance, 1e-12);
  control.apply({.closer = 1}, true, camera);
  EXPECT_LT(camera.distance(), distance);
}

}  // namespace
}  // namespace palpate
