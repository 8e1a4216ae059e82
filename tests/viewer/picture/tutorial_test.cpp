#include "viewer/picture/tutorial.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "tests/viewer/picture/mouse_run.hpp"
#include "viewer/picture/hand_control.hpp"

namespace palpate {
namespace {

/// What the person saw.
struct Shown {
  double largest_force = 0;  ///< N
  double deepest = 0;        ///< m
  double slid = 0;           ///< m, farthest anchor from the first
  double turned = 0;         ///< m, way of the camera
  std::set<std::string> captions;
};

/// Plays it as the picture does, to a person who presses `key_at` seconds after its beginning.
Shown play(test::MouseRun& run, double key_at = 1000) {
  HandControl control;
  control.playTutorial();
  Shown shown;
  const Eigen::Vector3d eye = run.camera.position();
  std::optional<Eigen::Vector3d> first;
  for (int picture = 0; picture < 60 * Tutorial::duration + 60; ++picture) {
    PersonsInput input;
    input.hand.seconds = 1.0 / 60;
    input.pressed_a_key = picture == std::lround(60 * key_at);
    const HapticState& state = run.act(control, input);
    if (control.marks().cursor) shown.captions.insert(control.marks().hint);
    if (!state.touch.touching) continue;
    if (!first) first = state.touch.anchor_position;
    shown.largest_force = std::max(shown.largest_force, state.force.norm());
    shown.deepest = std::max(shown.deepest, state.touch.displacement.norm());
    shown.slid = std::max(shown.slid, (state.touch.anchor_position - *first).norm());
  }
  EXPECT_FALSE(control.marks().cursor) << "it is over";
  shown.turned = (run.camera.position() - eye).norm();
  return shown;
}

TEST(Tutorial, PointsPressesSlidesGoesDeeperLetsGoAndTurnsTheBody) {
  const HapticModel cube = test::cubeModel(), blob = test::tenNodeModel();
  for (const HapticModel* model : {&cube, &blob}) {
    test::MouseRun run(*model);
    const Shown shown = play(run);
    EXPECT_GT(shown.largest_force, 0.1);
    EXPECT_GT(shown.deepest, 0.0105) << "deeper than it presses by itself";
    EXPECT_GT(shown.slid, 0.01);
    EXPECT_GT(shown.turned, 0.02);
    EXPECT_GE(shown.captions.size(), 6U);
    EXPECT_EQ(shown.captions.count(""), 0U);
    EXPECT_FALSE(run.state().touch.touching);
    EXPECT_LT(run.state().force.norm(), 1e-9);
  }
}

TEST(Tutorial, PressesNothingWhereNothingCanBeTouchedFromHere) {
  const Mesh mesh = test::blobMesh(6);
  const HapticModel blob = test::modelOf({mesh, {{mesh.node_groups.at("zmax").front()}}}, 0.03);
  test::MouseRun run(blob);
  run.look({0.2, 0.1, -1});
  EXPECT_EQ(play(run).largest_force, 0);
}

TEST(Tutorial, EndsWithWhateverThePersonPresses) {
  const HapticModel cube = test::cubeModel();
  test::MouseRun run(cube);
  const Shown shown = play(run, 2.5);  // while it presses
  EXPECT_GT(shown.largest_force, 0);
  EXPECT_EQ(shown.captions.size(), 2U);
  EXPECT_FALSE(run.state().touch.touching) << "its tool comes out";
}

}  // namespace
}  // namespace palpate
