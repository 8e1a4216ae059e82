#include "viewer/haptics/same_touch.hpp"

#include <gtest/gtest.h>

#include "tests/viewer/haptics/touched_model.hpp"

namespace palpate {
namespace {

/// The touch of a tool pressed 10 mm into the middle of the cube's top.
Touch pressed(const HapticModel& model) {
  Contact contact(model);
  for (int step = 0; step <= 100; ++step)
    contact.update({0.05, 0.05, 0.1001 - 0.0101 * step / 100});
  return contact.touch();
}

TEST(SameTouch, HasItsOwnForcesAtTheSamePlaceAndDisplacement) {
  const HapticModel soft = test::cubeModel();
  const HapticModel stiff = test::cubeModel([](const Eigen::Vector3d&) { return 3.0; });
  const Touch touch = pressed(soft);
  ASSERT_TRUE(touch.touching);
  const std::optional<Touch> same = sameTouch(soft, touch, stiff, 0);
  ASSERT_TRUE(same);
  EXPECT_NEAR((same->force - 3 * touch.force).norm(), 0, 1e-3 * touch.force.norm());
  EXPECT_EQ(same->displacement, touch.displacement);
  EXPECT_EQ(same->anchor_position, touch.anchor_position);
  const std::optional<Touch> itself = sameTouch(soft, touch, soft, 0);
  ASSERT_TRUE(itself);
  EXPECT_NEAR((itself->force - touch.force).norm(), 0, 1e-12);
}

TEST(SameTouch, IsEmptyForOtherBodiesMethodsAndUntouchablePlaces) {
  const HapticModel cube = test::cubeModel(), blob = test::tenNodeModel();
  const Touch touch = pressed(cube);
  EXPECT_FALSE(sameTouch(cube, touch, blob, 0));
  EXPECT_FALSE(sameTouch(cube, touch, cube, 7)) << "no such method";
  const Mesh mesh = test::cubeMesh(0.1, 4);
  const HapticModel corner = test::modelOf({mesh, {{mesh.node_groups.at("zmax").front()}}}, 0.03);
  EXPECT_FALSE(sameTouch(cube, touch, corner, 0)) << "only a corner can be touched";
  EXPECT_TRUE(sameTouch(cube, Touch(), corner, 0)) << "nothing is touched there either";
}

}  // namespace
}  // namespace palpate
