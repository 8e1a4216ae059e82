#include "viewer/picture/held_tool.hpp"

#include <gtest/gtest.h>

#include "tests/viewer/haptics/touched_model.hpp"

namespace palpate {
namespace {

class HeldToolTest : public ::testing::Test {
 protected:
  HeldToolTest() { camera.frame({0, 0, 0}, 0.1, {1, 0, 0}, Eigen::Vector3d::UnitZ(), 1); }
  void freeAbove(double gap) {
    HapticState state;
    const NearestPoint top = model.surface().tree().nearest({0.05, 0.05, 1});
    state.tool = top.position + gap * Eigen::Vector3d::UnitZ();
    held.update(model, state, true, camera, 0.1);
  }

  static const HapticModel& shared() {
    static const HapticModel model = test::cubeModel();
    return model;
  }
  const HapticModel& model = shared();
  OrbitCamera camera;
  HeldTool held;
};

TEST_F(HeldToolTest, PointsAwayFromTheSkinWithItsHandleTowardTheEye) {
  freeAbove(0.01);
  EXPECT_NEAR(held.pose().outward.z(), 1, 1e-9);
  EXPECT_NEAR(held.pose().handle.norm(), 1, 1e-12);
  EXPECT_GT(held.pose().handle.z(), 0.5);
  EXPECT_GT(held.pose().handle.dot(camera.axes().col(2)), 0);
  EXPECT_NEAR(held.skin().gap, 0.01, 1e-9);
}

TEST_F(HeldToolTest, ThrowsAShadowThatFadesWithTheGap) {
  freeAbove(0.001);
  const SoftLight::Shadow near = held.shadow(0.005);
  freeAbove(0.03);
  const SoftLight::Shadow far = held.shadow(0.005);
  EXPECT_GT(near.strength, far.strength);
  EXPECT_LT(near.radius, far.radius);
  freeAbove(0.2);
  EXPECT_EQ(held.shadow(0.005).strength, 0);
}

TEST_F(HeldToolTest, TurnsGradually) {
  freeAbove(0.01);
  HapticState state;
  state.touch.touching = true;
  state.tool = {0.05, 0.05, 0.09};
  state.touch.normal = Eigen::Vector3d::UnitX();
  held.update(model, state, true, camera, 0.1);
  EXPECT_LT(held.pose().outward.x(), 0.5);
  for (int n = 0; n < 60; ++n) held.update(model, state, true, camera, 0.1);
  EXPECT_GT(held.pose().outward.x(), 0.99);
}

}  // namespace
}  // namespace palpate
