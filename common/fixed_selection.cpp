#include "common/fixed_selection.hpp"

#include "common/error.hpp"
#include "common/nearest_word.hpp"

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
  throw badInput("fixed.{} selects no node; the mesh reaches from {} to {} m", key, placeText(box.min()),
                 placeText(box.max()));
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

const NodeSet& groupNamed(const Mesh& mesh, const std::string& name) {
  const auto found = mesh.node_groups.find(name);
  if (found != mesh.node_groups.end()) {
    if (found->second.empty())
      throw badInput("fixed.group: no node of \"{}\" belongs to a tetrahedron", name);
    return found->second;
  }
  std::vector<std::string_view> names;
  for (const auto& [group, nodes] : mesh.node_groups) names.push_back(group);
  if (names.empty()) throw badInput("fixed.group: there is no \"{}\": the mesh has no physical groups", name);
  throw badInput("fixed.group: there is no \"{}\"; the mesh has {}", name, listed(names));
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
    select(fixed, mesh, "box", [&](const Eigen::Vector3d& x) {
      return (x.array() >= box.lowest.array()).all() && (x.array() <= box.highest.array()).all();
    });
  for (const Sphere& sphere : selection.spheres)
    select(fixed, mesh, "sphere", [&](const Eigen::Vector3d& x) {
      return (x - sphere.center).squaredNorm() <= sphere.radius * sphere.radius * on_the_sphere;
    });
  for (const std::string& group : selection.groups) {
    const NodeSet& nodes = groupNamed(mesh, group);
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
