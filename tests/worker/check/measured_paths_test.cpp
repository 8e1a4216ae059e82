#include "worker/check/measured_paths.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/meshes.hpp"
#include "tests/support/problems.hpp"

namespace palpate {
namespace {

/// A cube of 200 mm, touched in the middle of its top. A flat contact pushes at most 75 degrees off
/// the inward normal.
Problem touchedCube() {
  Scene scene = test::mooneyRivlinScene();
  scene.fixed.groups = {"zmin"};
  scene.active = {{.name = "top",
                   .near = Eigen::Vector3d(0.1, 0.1, 0.2),
                   .radius = 0.06,
                   .tool = ToolKind::finger}};
  scene.workspace.radius = 0.01;
  scene.workspace.spacing = 0.0025;
  scene.workspace.max_force = 100;  // N: no path ends there
  return resolve(std::move(scene), test::cubeMesh(0.2, 4));
}

TEST(MeasuredPaths, OfAFingerOnlyPushAndNoneIsEmpty) {
  // The 50 transitions are those of the first 13 paths; the last of these paths is cut short.
  const MeasuredPaths found = measurePaths(touchedCube(), {.seconds = 1e9, .transitions = 50});
  EXPECT_EQ(found.paths.size(), 13u);
  for (const Path& path : found.paths) {
    // A path that pulls leaves the pushed part, and half a spacing of room, before its second
    // point.
    EXPECT_GE(path.steps.size(), 2u);
    EXPECT_TRUE(std::ranges::all_of(path.steps, &PathStep::reached));
  }
  EXPECT_EQ(std::ranges::count(found.paths, PathEnd::rim, &Path::end), 12);
  EXPECT_EQ(std::ranges::count(found.paths, PathEnd::cut, &Path::end), 1)
      << "the path that leads along the surface";
}

}  // namespace
}  // namespace palpate
