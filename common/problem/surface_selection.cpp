#include "common/problem/surface_selection.hpp"

#include <algorithm>
#include <iterator>
#include <set>

#include "common/base/error.hpp"
#include "common/problem/node_selectors.hpp"

namespace palpate {
namespace {

/// Adds the nodes of `surface` for which `inside` holds; Error when there are none.
template <class Inside>
void select(NodeSet& selected, const NodeSet& surface, const std::string& key, Inside inside) {
  const std::size_t before = selected.size();
  std::copy_if(surface.begin(), surface.end(), std::back_inserter(selected), inside);
  if (selected.size() == before) throw badInput("{}: holds no node of the surface", key);
}

NodeSet selectOnSurface(const SurfaceSelection& selection, const std::string& key, const Mesh& mesh,
                        const NodeSet& surface) {
  if (selection.all) return surface;
  NodeSet selected;
  for (const Box& box : selection.boxes)
    select(selected, surface, key + ".box",
           [&](std::int32_t node) { return isIn(box, mesh.nodes[node]); });
  for (const Sphere& sphere : selection.spheres)
    select(selected, surface, key + ".sphere",
           [&](std::int32_t node) { return isIn(sphere, mesh.nodes[node]); });
  for (const std::string& group : selection.groups) {
    const NodeSet& nodes = groupNamed(mesh, group, key + ".group");
    select(selected, surface, fmt::format("{}.group: \"{}\"", key, group),
           [&](std::int32_t node) { return contains(nodes, node); });
  }
  sortUnique(selected);
  return selected;
}

NodeSet movableOf(const ActiveSelection& selection, const Mesh& mesh, const NodeSet& surface,
                  const NodeSet& fixed) {
  const std::string key = fmt::format("active \"{}\": surface", selection.name);
  const NodeSet selected = selectOnSurface(*selection.surface, key, mesh, surface);
  NodeSet movable;
  std::set_difference(selected.begin(), selected.end(), fixed.begin(), fixed.end(),
                      std::back_inserter(movable));
  if (movable.empty())
    throw badInput("{}: all {} nodes of the surface in it are fixed; move it, or fix less", key,
                   selected.size());
  return movable;
}

}  // namespace

std::vector<ActiveSelection> expandSurfaces(const std::vector<ActiveSelection>& selections,
                                            const Mesh& mesh, const NodeSet& fixed) {
  const NodeSet surface = surfaceNodes(mesh);
  std::vector<ActiveSelection> expanded;
  for (const ActiveSelection& selection : selections) {
    if (!selection.surface) {
      expanded.push_back(selection);
      continue;
    }
    for (const std::int32_t node : movableOf(selection, mesh, surface, fixed)) {
      ActiveSelection& one = expanded.emplace_back(selection);
      one.name = fmt::format("{}-{}", selection.name, node);
      one.surface.reset();
      one.node = node;
    }
  }
  std::set<std::string> names;
  for (const ActiveSelection& one : expanded)
    if (!names.insert(one.name).second)
      throw badInput(
          "two active nodes are called \"{}\", one of them by a surface; rename the other",
          one.name);
  return expanded;
}

}  // namespace palpate
