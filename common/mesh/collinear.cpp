#include "common/mesh/collinear.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "common/base/assertion.hpp"

namespace palpate {

bool areCollinear(const NodeSet& nodes, const Mesh& mesh) {
  PALPATE_ASSERT(!nodes.empty(), "a line has a node");
  const Eigen::Vector3d& a = mesh.nodes[nodes.front()];
  const std::int32_t far = *std::ranges::max_element(
      nodes, {}, [&](std::int32_t n) { return (mesh.nodes[n] - a).norm(); });
  const Eigen::Vector3d along = (mesh.nodes[far] - a).stableNormalized();
  const double near = 1e-6 * boundingBox(mesh).diagonal().norm();
  return std::ranges::all_of(
      nodes, [&](std::int32_t n) { return (mesh.nodes[n] - a).cross(along).norm() <= near; });
}

}  // namespace palpate
