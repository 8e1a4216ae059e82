#include "common/problem/patch_selection.hpp"

#include <numeric>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/mesh/bump_integrals.hpp"

namespace palpate {
namespace {

std::int32_t nearestOf(const NodeSet& candidates, const Mesh& mesh, const Eigen::Vector3d& x) {
  const auto distance = [&](std::int32_t n) { return (mesh.nodes[n] - x).squaredNorm(); };
  return *std::min_element(
      candidates.begin(), candidates.end(),
      [&](std::int32_t a, std::int32_t b) { return distance(a) < distance(b); });
}

std::int32_t selectActiveNode(const ActiveSelection& selection, const Mesh& mesh,
                              const NodeSet& surface) {
  if (selection.near) {
    const std::int32_t node = nearestOf(surface, mesh, *selection.near);
    const double distance = (mesh.nodes[node] - *selection.near).norm();
    if (distance > boundingBox(mesh).diagonal().norm())
      throw badInput(
          "active \"{}\": near = {} is {:.4g} m away from the nearest surface node, "
          "more than the body is wide; is its unit that of length_unit?",
          selection.name, placeText(*selection.near), distance);
    return node;
  }
  const std::int32_t node = *selection.node;
  if (node >= mesh.vertices())
    throw badInput("active \"{}\": there is no node {}; the mesh has nodes 0 to {}", selection.name,
                   node, mesh.vertices() - 1);
  if (!contains(surface, node))
    throw badInput(
        "active \"{}\": node {} at {} is inside the body; the nearest surface node is {}",
        selection.name, node, placeText(mesh.nodes[node]),
        nearestOf(surface, mesh, mesh.nodes[node]));
  return node;
}

NodeSet allNodes(const Mesh& mesh) {
  NodeSet nodes(mesh.nodes.size());
  std::iota(nodes.begin(), nodes.end(), 0);
  return nodes;
}

/// The vertices `surface`, and the middles of their triangles' edges.
NodeSet withMidEdgeNodes(NodeSet surface, const Mesh& mesh) {
  if (mesh.edges.empty()) return surface;
  for (const Triangle& t : mesh.surface)
    for (int i = 0; i < 3; ++i) surface.push_back(midEdgeNode(mesh, t[i], t[(i + 1) % 3]));
  sortUnique(surface);
  return surface;
}

std::vector<double> weightsOf(const ActivePatch& patch, const Mesh& mesh, double radius) {
  if (patch.nodes.size() < 3)
    throw badInput(
        "active \"{}\": only {} movable surface node(s) "
        "lie within its radius of {:.4g} m (edges are {:.4g} m on average); "
        "a weighted average needs at least 3: make radius larger, or the mesh finer there",
        patch.name, patch.nodes.size(), radius, measure(mesh).mean_edge);
  const std::vector<double> integrals = bumpIntegrals(mesh, mesh.nodes[patch.node], radius);
  std::vector<double> weights;
  for (const std::int32_t node : patch.nodes) weights.push_back(integrals[node]);
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  if (!(sum > 0))
    throw badInput(
        "active \"{}\": the weights of its {} nodes do not have a positive sum; make radius larger",
        patch.name, patch.nodes.size());
  for (double& weight : weights) weight /= sum;
  return weights;
}

}  // namespace

ActivePatch selectPatch(const ActiveSelection& selection, const Mesh& mesh, const NodeSet& fixed) {
  const NodeSet surface = surfaceNodes(mesh);
  const bool weighted = selection.tool == ToolKind::weighted_average;
  ActivePatch patch;
  patch.name = selection.name;
  patch.node = selectActiveNode(selection, mesh, surface);
  const Eigen::Vector3d& center = mesh.nodes[patch.node];
  for (const std::int32_t node : weighted ? withMidEdgeNodes(surface, mesh) : allNodes(mesh)) {
    const bool within = (mesh.nodes[node] - center).squaredNorm() <=
                        selection.radius * selection.radius * on_the_sphere;
    if (node == patch.node || (within && !contains(fixed, node))) patch.nodes.push_back(node);
  }
  PALPATE_ASSERT(contains(patch.nodes, patch.node),
                 "the tool moves what displacements are named by");
  if (weighted) patch.weights = weightsOf(patch, mesh, selection.radius);
  return patch;
}

}  // namespace palpate
