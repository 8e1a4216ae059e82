#include "viewer/picture/mouse_hand.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "tests/viewer/picture/mouse_run.hpp"
#include "viewer/picture/hand_control.hpp"

namespace palpate {
namespace {

/// A cube of 100 mm that is touchable everywhere, and the blob, which is touchable above.
class MouseHandTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    cube = new HapticModel(test::cubeModel());
    blob = new HapticModel(test::tenNodeModel());
  }
  static void TearDownTestSuite() {
    delete cube;
    delete blob;
  }
  static Eigen::Vector3d top() { return {0.05, 0.05, 0.1}; }
  static double depthUnder(const Eigen::Vector3d& place, const test::MouseRun& run) {
    return place.z() - run.state().tool.z();
  }

  static inline HapticModel *cube = nullptr, *blob = nullptr;
};

TEST_F(MouseHandTest, HoversBeforeTheSkinAtThePointedPlace) {
  test::MouseRun run(*cube);
  run.act({.pointer = run.onScreen(top())}, 20);
  ASSERT_TRUE(run.hand.place());
  EXPECT_NEAR((run.hand.place()->position - top()).norm(), 0, 1e-9);
  EXPECT_FALSE(run.hand.holds());
  EXPECT_NEAR((run.state().tool - top()).head<2>().norm(), 0, 1e-6);
  EXPECT_GT(run.state().tool.z(), 0.1005);
  EXPECT_LT(run.state().tool.z(), 0.105);
  EXPECT_GT(run.state().touch.gap, 0);
  EXPECT_FALSE(run.touched);
}

TEST_F(MouseHandTest, IsAwayIfNothingIsPointedAt) {
  test::MouseRun run(*cube);
  run.act({}, 3);
  EXPECT_EQ(run.state().reading.status, DeviceStatus::away);
  run.act({.pointer = run.onScreen(top())}, 3);
  EXPECT_EQ(run.state().reading.status, DeviceStatus::fresh);
  run.act({.pointer = {0.7, 0.45}}, 3);
  EXPECT_FALSE(run.hand.place());
  EXPECT_EQ(run.state().reading.status, DeviceStatus::away);
  EXPECT_EQ(run.state().guards, 0U) << "which is not a fault";
}

TEST_F(MouseHandTest, PressesAlongTheNormalWhileTheButtonIsHeldAndComesOutAgain) {
  test::MouseRun run(*cube);
  HandInput input{.pointer = run.onScreen(top())};
  run.act(input);
  input.button = true;
  run.act(input, 60);
  EXPECT_TRUE(run.hand.holds());
  EXPECT_NEAR(depthUnder(top(), run), 0.01, 1e-4);
  EXPECT_TRUE(run.state().touch.touching);
  EXPECT_GT(run.state().force.z(), 0.1);
  input.button = false;
  run.act(input, 40);
  EXPECT_FALSE(run.hand.holds());
  EXPECT_FALSE(run.state().touch.touching);
  EXPECT_GT(run.state().touch.gap, 0);
  EXPECT_LT(run.state().force.norm(), 1e-9);
}

TEST_F(MouseHandTest, PressesAtOnceWithoutHoveringFirst) {
  test::MouseRun run(*cube);
  run.act({.pointer = run.onScreen(top()), .button = true}, 60);
  EXPECT_TRUE(run.state().touch.touching);
  EXPECT_NEAR((run.state().touch.anchor_position - top()).norm(), 0, 1e-6);
}

TEST_F(MouseHandTest, GoesDeeperWithTheWheelWithinTheComputedRegion) {
  test::MouseRun run(*cube);
  const HandInput input{.pointer = run.onScreen(top()), .button = true};
  run.act(input, 60);
  HandInput turned = input;
  turned.deeper = 5;
  run.act(turned, 60);
  const double step = run.model().spaces().front().lattice.radius() / 50;
  EXPECT_NEAR(depthUnder(top(), run), 0.01 + 5 * step, 1e-4);
  turned.deeper = 1000;
  run.act(turned, 120);
  EXPECT_NEAR(depthUnder(top(), run), 0.95 * 50 * step, 1e-4);
  EXPECT_TRUE(run.state().touch.inside);
  turned.deeper = -1000;
  run.act(turned, 120);
  EXPECT_GT(depthUnder(top(), run), 0) << "the button is still held";
}

TEST_F(MouseHandTest, FollowsThePointerOverTheSkin) {
  test::MouseRun run(*cube);
  run.act({.pointer = run.onScreen(top()), .button = true}, 60);
  const Eigen::Vector3d there = top() + Eigen::Vector3d(0.02, -0.03, 0);
  run.act({.pointer = run.onScreen(there), .button = true}, 60);
  ASSERT_TRUE(run.hand.place());
  EXPECT_NEAR((run.hand.place()->position - there).norm(), 0, 1e-6);
  const Eigen::Vector3d pressed = there - 0.01 * run.hand.place()->normal;
  EXPECT_NEAR((run.state().tool - pressed).norm(), 0, 1e-4) << "as deep as before";
  EXPECT_LT((run.state().touch.anchor_position - there).norm(), 0.008) << "except for friction";
}

TEST_F(MouseHandTest, StaysInPlaceWhenThePointerLeavesTheBody) {
  test::MouseRun run(*cube);
  run.act({.pointer = run.onScreen(top()), .button = true}, 60);
  run.act({.pointer = {0.7, 0.45}, .button = true}, 60);
  EXPECT_TRUE(run.hand.holds());
  EXPECT_TRUE(run.state().touch.touching);
  EXPECT_NEAR((run.state().tool - top()).head<2>().norm(), 0, 1e-3);
}

TEST_F(MouseHandTest, TouchesNothingOnItsWayToAnotherSide) {
  test::MouseRun run(*cube);
  const Eigen::Vector3d sides[] = {{0.1, 0.05, 0.05}, {0, 0.05, 0.05}, {0.05, 0.1, 0.05}};
  for (const Eigen::Vector3d& side : sides) {
    run.look(side - Eigen::Vector3d::Constant(0.05) + Eigen::Vector3d(0, 0, 0.01));
    run.act({.pointer = run.onScreen(side)}, 30);
    ASSERT_TRUE(run.hand.place());
    EXPECT_NEAR((run.hand.place()->position - side).norm(), 0, 1e-9);
    EXPECT_GT(run.state().touch.gap, 0);
  }
  EXPECT_FALSE(run.touched);
}

TEST_F(MouseHandTest, DoesNotHoldUntouchableParts) {
  test::MouseRun run(*blob);
  run.look({0.2, 0.1, -1});  // from below
  run.act({.pointer = {0, 0}, .button = true}, 30);
  ASSERT_TRUE(run.hand.seen());
  EXPECT_FALSE(run.hand.seen()->touchable);
  EXPECT_FALSE(run.hand.place() || run.hand.holds());
  EXPECT_FALSE(run.touched);
}

TEST_F(MouseHandTest, OneKeyReleasesWhileTheButtonIsStillHeld) {
  test::MouseRun run(*cube);
  HandInput input{.pointer = run.onScreen(top()), .button = true};
  run.act(input, 60);
  input.out = true;
  run.act(input, 60);
  EXPECT_FALSE(run.state().touch.touching);
  EXPECT_GT(run.state().touch.gap, 0);
}

TEST_F(MouseHandTest, CanBeSteeredByKeysAlone) {
  test::MouseRun run(*cube);
  run.act({.take = true}, 60);
  ASSERT_TRUE(run.state().touch.touching) << "it took hold of what is in front";
  const Eigen::Vector3d from = run.hand.place()->position;
  run.act({.strokes = {3, 0}}, 30);
  EXPECT_GT((run.hand.place()->position - from).dot(run.camera.axes().col(0)), 0.002);
  const double depth = run.state().touch.displacement.norm();
  run.act({.deeper = 3}, 60);
  EXPECT_GT(run.state().touch.displacement.norm(), depth + 1e-3);
  run.act({.take = true}, 60);
  EXPECT_FALSE(run.state().touch.touching);
  const Eigen::Vector3d before = run.hand.place()->position;
  run.act({.strokes = {0, 2}}, 10);
  EXPECT_GT((run.hand.place()->position - before).norm(), 0.001) << "and can be moved outside too";
  EXPECT_FALSE(run.state().touch.touching);
}

TEST_F(MouseHandTest, OneKeyReleasesAPressByKeysToo) {
  test::MouseRun run(*cube);
  run.act({.take = true}, 60);
  ASSERT_TRUE(run.hand.holdsByKey() && run.state().touch.touching);
  run.act({.out = true}, 40);
  EXPECT_FALSE(run.hand.holds() || run.state().touch.touching);
}

TEST_F(MouseHandTest, TheButtonTakesOverAPressByKeys) {
  test::MouseRun run(*cube);
  run.act({.take = true}, 60);
  ASSERT_TRUE(run.state().touch.touching);
  const Eigen::Vector3d there = top() + Eigen::Vector3d(0.02, -0.03, 0);
  const HandInput press{.pointer = run.onScreen(there), .button = true};
  run.act(press);
  EXPECT_TRUE(run.hand.holds());
  EXPECT_FALSE(run.hand.holdsByKey());
  EXPECT_FALSE(run.state().touch.touching) << "first it is outside, before the place";
  run.act(press, 60);
  EXPECT_TRUE(run.state().touch.touching);
  const Eigen::Vector3d pressed = there - 0.01 * run.hand.place()->normal;
  EXPECT_NEAR((run.state().tool - pressed).norm(), 0, 1e-4);
  run.act({.pointer = press.pointer}, 40);
  EXPECT_FALSE(run.hand.holds() || run.state().touch.touching) << "its button holds now";
}

TEST_F(MouseHandTest, TheButtonOffTheTouchablePartReleasesAPressByKeys) {
  test::MouseRun run(*cube);
  run.act({.take = true}, 60);
  run.act({.pointer = run.onScreen(top())}, 10);
  EXPECT_TRUE(run.hand.holdsByKey()) << "pointing ends nothing";
  run.act({.pointer = {0.7, 0.45}, .button = true}, 40);
  EXPECT_FALSE(run.hand.holds() || run.state().touch.touching);
}

TEST_F(MouseHandTest, LeavesTheDragThatEndsAPressByKeysToTheCamera) {
  test::MouseRun run(*cube);
  HandControl control;
  PersonsInput input;
  const auto act = [&](int pictures) {
    input.hand.seconds = 1.0 / 60;
    for (int picture = 0; picture < pictures; ++picture) run.act(control, input);
    return run.state().touch.touching;
  };
  input.hand.take = true;
  act(1);
  input.hand.take = false;
  ASSERT_TRUE(act(60));
  const Eigen::Vector3d eye = run.camera.position();
  input.motion = {.right = 0.005, .at = {0.7, 0.45}, .left = true};
  EXPECT_TRUE(act(40)) << "a click on a panel is not one on the body";
  EXPECT_EQ(run.camera.position(), eye);
  input.motion.left = false;
  act(1);
  input.motion.left = input.motion.over_view = true;
  EXPECT_FALSE(act(40));
  EXPECT_GT((run.camera.position() - eye).norm(), 0.01);
}

TEST_F(MouseHandTest, PullsGluedTissue) {
  test::MouseRun run(*blob, ContactMode::glued);
  const Eigen::Vector2d at = run.onScreen(touchablePlace(blob->surface(), {0, 0, 0.2}).position);
  run.act({.pointer = at}, 30);
  EXPECT_TRUE(run.hand.place());
  EXPECT_FALSE(run.touched) << "pointing takes no hold";
  run.act({.pointer = at, .button = true}, 30);
  EXPECT_TRUE(run.state().touch.touching);
  EXPECT_LT(run.state().touch.displacement.norm(), 1e-4);
  const Eigen::Vector2d moved = at + Eigen::Vector2d(0.03, 0.02);
  run.act({.pointer = moved, .button = true}, 30);
  const Eigen::Vector3d pulled = run.state().touch.displacement;
  EXPECT_NEAR((run.onScreen(run.state().tool) - moved).norm(), 0, 1e-3) << "under the pointer";
  EXPECT_GT(pulled.norm(), 0.002);
  EXPECT_LT(run.state().force.dot(pulled), 0);
  run.act({.pointer = {0.7, 0.4}, .button = true}, 30);
  EXPECT_LT(run.state().touch.displacement.norm(), 0.03) << "not beyond the computed region";
  run.act({.pointer = moved}, 30);
  EXPECT_FALSE(run.state().touch.touching);
  EXPECT_LT(run.state().force.norm(), 1e-9);
}

TEST_F(MouseHandTest, DoesNotTouchForAQuarterSecondAfterReleasing) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-0.45, 0.45);
  for (const HapticModel* model : {cube, blob}) {
    test::MouseRun run(*model);
    int touches = 0;
    for (int n = 0; n < 60; ++n) {
      run.look({number(random), number(random), number(random)});
      const Eigen::Vector2d middle =
          run.onScreen(touchablePlace(model->surface(), run.camera.position()).position);
      HandInput input{.pointer = middle + 0.3 * Eigen::Vector2d(number(random), number(random)),
                      .button = n % 3 != 0};
      run.act(input, 10);
      input.pointer += 0.2 * Eigen::Vector2d(number(random), number(random));
      input.deeper = 20 * number(random);
      touches += run.act(input, 10).touch.touching ? 1 : 0;
      input.button = false;
      run.act(input, 15);
      EXPECT_FALSE(run.state().touch.touching) << "gesture " << n;
      EXPECT_TRUE(run.state().reading.status == DeviceStatus::away || run.state().touch.gap > 0)
          << "gesture " << n << ": the tool is inside";
    }
    EXPECT_GT(touches, 5);
  }
}

/// Regression: hints for keys mentioned a button that nobody held.
TEST_F(MouseHandTest, HasADifferentHintInEachState) {
  test::MouseRun run(*cube);
  std::set<std::string> hints;
  const auto act = [&](const HandInput& input, int pictures) {
    run.act(input, pictures);
    hints.insert(handHint(run.state(), ContactMode::unilateral, run.hand));
  };
  act({}, 2);
  act({.pointer = run.onScreen(top())}, 2);
  act({.pointer = run.onScreen(top()), .button = true}, 30);
  EXPECT_EQ(deviceHint(run.state()), "");
  HapticState lost_inside = run.state();
  lost_inside.touch = {};
  lost_inside.touch.gap = -0.01;
  hints.insert(handHint(lost_inside, ContactMode::unilateral, run.hand));
  EXPECT_NE(deviceHint(lost_inside), "");
  act({}, 40);
  act({.strokes = {1, 0}}, 2);
  act({.take = true}, 30);
  EXPECT_FALSE(hints.contains(""));
  EXPECT_EQ(hints.size(), 6U) << "idle, pointed at, pressed, inside; a ring, pressed by keys";
}

}  // namespace
}  // namespace palpate
