#include "viewer/picture/tool_view.hpp"

#include <gtest/gtest.h>

#include "tests/support/finger_body.hpp"
#include "tests/viewer/haptics/touched_model.hpp"

namespace palpate {
namespace {

TEST(ToolShape, ASingleNodeIsAPoint) {
  EXPECT_EQ(toolOf(test::modelOf({test::cubeMesh(0.1, 4), {{112}}}), 0), ToolShape{});
}

TEST(ToolShape, APatchIsADiscThatCoversIt) {
  const Mesh mesh = test::cubeMesh(0.1, 4);
  const Eigen::Vector3d middle = mesh.nodes[112];
  test::TouchableBody body(mesh, {{112}});
  std::vector<std::int32_t>& nodes = body.problem.active[0].nodes;
  nodes.clear();
  double farthest = 0;
  for (const std::int32_t node : mesh.node_groups.at("zmax")) {
    const double distance = (mesh.nodes[static_cast<std::size_t>(node)] - middle).norm();
    if (distance > 0.03) continue;
    nodes.push_back(node);
    farthest = std::max(farthest, distance);
  }
  body.spaces[0].patch = body.problem.active[0];
  const ToolShape tool = toolOf(test::modelOf(body), 0);
  EXPECT_EQ(tool.form, ToolForm::disc);
  EXPECT_NEAR(tool.radius, farthest, 1e-9);
}

TEST(ToolShape, AFingerHasItsRadius) {
  const test::TemporaryDirectory directory;
  test::FingerBody().seal(directory / "body.h5");
  const HapticModel model{Dataset(directory / "body.h5")};
  EXPECT_EQ(toolOf(model, 0), (ToolShape{ToolForm::finger, 0.02}));
}

}  // namespace
}  // namespace palpate
