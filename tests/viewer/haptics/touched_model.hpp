#pragma once

#include <algorithm>
#include <functional>
#include <vector>

#include "tests/support/meshes.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/touchable_body.hpp"
#include "viewer/haptics/contact.hpp"

namespace palpate::test {

/// Seals the body and reads it back as a haptic model.
inline HapticModel modelOf(const TouchableBody& body, double reach = 0) {
  const TemporaryDirectory directory;
  body.seal(directory / "body.h5");
  const Dataset dataset(directory / "body.h5");
  return HapticModel(dataset, {.methods = {"potential", "trilinear"}, .reach = reach});
}

/// A cube of 100 mm, all of it touchable, with every vertex of its top active.
inline HapticModel cubeModel(const std::function<double(const Eigen::Vector3d&)>& factor =
                                 [](const Eigen::Vector3d&) { return 1.0; }) {
  const Mesh mesh = cubeMesh(0.1, 4);
  std::vector<TouchableBody::Active> active;
  for (const std::int32_t node : mesh.node_groups.at("zmax"))
    active.push_back({node, factor(mesh.nodes[static_cast<std::size_t>(node)])});
  return modelOf({mesh, active}, 0.2);
}

/// The cube at a tenth of its size, at a distance from the origin.
inline HapticModel smallCubeModel() {
  Mesh mesh = cubeMesh(0.01, 4);
  for (Eigen::Vector3d& node : mesh.nodes) node.x() += 0.5;
  std::vector<TouchableBody::Active> active;
  for (const std::int32_t node : mesh.node_groups.at("zmax")) active.push_back({node});
  return modelOf({mesh, active, 0.003, 0.0015}, 0.02);
}

/// The blob with ten active nodes on its upper side, with factors from 0.8 to 1.25, touchable
/// everywhere.
inline HapticModel tenNodeModel() {
  const Mesh mesh = blobMesh(6);
  std::vector<TouchableBody::Active> active;
  for (const Eigen::Vector2d& x :
       {Eigen::Vector2d(0, 0), Eigen::Vector2d(0.03, 0), Eigen::Vector2d(-0.03, 0),
        Eigen::Vector2d(0, 0.025), Eigen::Vector2d(0, -0.025), Eigen::Vector2d(0.05, 0.02),
        Eigen::Vector2d(-0.05, 0.02), Eigen::Vector2d(0.05, -0.02), Eigen::Vector2d(-0.05, -0.02),
        Eigen::Vector2d(0.07, 0)}) {
    const std::vector<std::int32_t>& top = mesh.node_groups.at("zmax");
    const auto distance = [&](std::int32_t node) {
      return (mesh.nodes[node].head<2>() - x).norm();
    };
    const std::int32_t node = *std::ranges::min_element(top, {}, distance);
    if (std::ranges::none_of(active, [node](const auto& one) { return one.node == node; }))
      active.push_back({node, 0.8 + 0.05 * static_cast<double>(active.size())});
  }
  return modelOf({mesh, active}, 0.06);
}

}  // namespace palpate::test
