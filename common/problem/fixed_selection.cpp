#include "common/problem/fixed_selection.hpp"

#include "common/base/error.hpp"
#include "common/problem/node_selectors.hpp"

namespace palpate {
namespace {

/// Adds the nodes for which `inside` holds; Error when there are none.
template <class Inside>
void select(NodeSet& fixed, const Mesh& mesh, const std::string& key, Inside inside) {
  const std::size_t before = fixed.size();
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (inside(mesh.nodes[n])) fixed.push_back(static_cast<std::int32_t>(n));
  if (fixed.size() > before) return;
  const Eigen::AlignedBox3d box = boundingBox(mesh);
  throw badInput("fixed.{} selects no node; the mesh reaches from {} to {} m", key,
                 placeText(box.min()), placeText(box.max()));
}

void selectHalfSpace(NodeSet& fixed, const Mesh& mesh, const HalfSpace& half) {
  const Eigen::AlignedBox3d box = boundingBox(mesh);
  const int axis = half.axis;
  const double extent = box.sizes()[axis];
  const double plane = half.at      ? *half.at
                       : half.below ? box.min()[axis] + *half.fraction * extent
                                    : box.max()[axis] - *half.fraction * extent;
  select(fixed, mesh, half.below ? "below" : "above",
         [&](const Eigen::Vector3d& x) { return half.below ? x[axis] < plane : x[axis] > plane; });
}

/// The mid-edge nodes between two listed vertices.
void addNodesBetween(NodeSet listed, const Mesh& mesh, NodeSet& fixed) {
  sortUnique(listed);
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (contains(listed, mesh.edges[e][0]) && contains(listed, mesh.edges[e][1]))
      fixed.push_back(mesh.vertices() + static_cast<std::int32_t>(e));
}

}  // namespace

NodeSet selectFixed(const FixedSelection& selection, const Mesh& mesh) {
  NodeSet fixed;
  for (const HalfSpace& half : selection.half_spaces) selectHalfSpace(fixed, mesh, half);
  for (const Box& box : selection.boxes)
    select(fixed, mesh, "box", [&](const Eigen::Vector3d& x) { return isIn(box, x); });
  for (const Sphere& sphere : selection.spheres)
    select(fixed, mesh, "sphere", [&](const Eigen::Vector3d& x) { return isIn(sphere, x); });
  for (const std::string& group : selection.groups) {
    const NodeSet& nodes = groupNamed(mesh, group, "fixed.group");
    fixed.insert(fixed.end(), nodes.begin(), nodes.end());
  }
  for (const std::int32_t node : selection.nodes) {
    if (node >= mesh.vertices())
      throw badInput("fixed.nodes: there is no node {}; the mesh has nodes 0 to {}", node,
                     mesh.vertices() - 1);
    fixed.push_back(node);
  }
  addNodesBetween(selection.nodes, mesh, fixed);
  sortUnique(fixed);
  return fixed;
}

}  // namespace palpate
