#include "viewer/picture/view_control.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

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
