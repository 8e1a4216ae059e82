#include "common/problem/selection.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <numeric>
#include <set>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/number_text.hpp"
#include "common/base/text.hpp"
#include "common/mesh/bump_integrals.hpp"
#include "common/problem/finger.hpp"
#include "common/problem/sites.hpp"
#include "common/scene/key_lines.hpp"

namespace palpate {
namespace {

// ---- places ---------------------------------------------------------------------------------

bool isIn(const Box& box, const Eigen::Vector3d& x) {
  return (x.array() >= box.lowest.array()).all() && (x.array() <= box.highest.array()).all();
}

bool isIn(const Sphere& sphere, const Eigen::Vector3d& x) {
  return (x - sphere.center).squaredNorm() <= sphere.radius * sphere.radius * on_the_sphere;
}

/// Returns the entry with this name. If there is none, throws an Error that begins with `missing`
/// and lists the existing names. If there are no names at all, the Error says that the mesh has no
/// `what`, a plural noun.
template <class Named>
const auto& entryNamed(const Named& named, const std::string& name, std::string_view missing,
                       const char* what) {
  const auto found = named.find(name);
  if (found != named.end()) return found->second;
  std::vector<std::string_view> names;
  for (const auto& [other, values] : named) names.push_back(other);
  throw badInput("{}; the mesh has {}", missing,
                 names.empty() ? fmt::format("no {}", what) : listed(names));
}

/// Returns the nodes of a physical group, including mid-edge nodes. Errors begin with `key`.
const NodeSet& groupNamed(const Mesh& mesh, const std::string& name, std::string_view key) {
  const NodeSet& group = entryNamed(
      mesh.node_groups, name, fmt::format("{}: there is no \"{}\"", key, name), "physical groups");
  if (group.empty())
    throw badInput("{}: group \"{}\" has no node of a tetrahedron; name another", key, name);
  return group;
}

/// Adds the candidates for which inside(node) is true. If there are none, throws the Error that
/// nothing() returns.
template <class Inside, class Nothing>
void select(NodeSet& selected, const NodeSet& candidates, Inside inside, Nothing nothing) {
  const std::size_t before = selected.size();
  std::ranges::copy_if(candidates, std::back_inserter(selected), inside);
  if (selected.size() == before) throw nothing();
}

/// Adds the candidates in each box and each sphere of the selection. If a box or sphere contains
/// none, throws the Error that nothing(key) returns.
template <class Selection, class Nothing>
void selectPlaces(NodeSet& selected, const Selection& selection, const NodeSet& candidates,
                  const Mesh& mesh, Nothing nothing) {
  const auto selectIn = [&](const auto& places, const char* key) {
    for (const auto& place : places)
      select(
          selected, candidates, [&](std::int32_t node) { return isIn(place, mesh.nodes[node]); },
          [&] { return nothing(key); });
  };
  selectIn(selection.boxes, "box");
  selectIn(selection.spheres, "sphere");
}

// ---- [fixed] --------------------------------------------------------------------------------

/// Returns whether the half space contains x. `box` is the bounding box of the mesh.
bool isIn(const HalfSpace& half, const Eigen::AlignedBox3d& box, const Eigen::Vector3d& x) {
  const double extent = box.sizes()[half.axis];
  const double plane = half.at      ? *half.at
                       : half.below ? box.min()[half.axis] + *half.fraction * extent
                                    : box.max()[half.axis] - *half.fraction * extent;
  return half.below ? x[half.axis] < plane : x[half.axis] > plane;
}

/// Adds to `fixed` the mid-edge nodes of edges with both vertices in `listed`.
void addNodesBetween(NodeSet listed, const Mesh& mesh, NodeSet& fixed) {
  sortUnique(listed);
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (contains(listed, mesh.edges[e][0]) && contains(listed, mesh.edges[e][1]))
      fixed.push_back(mesh.vertices() + static_cast<std::int32_t>(e));
}

// ---- `surface` of [[active]] ----------------------------------------------------------------

NodeSet selectOnSurface(const SurfaceSelection& selection, const std::string& key, const Mesh& mesh,
                        const NodeSet& surface) {
  if (selection.all) return surface;
  const auto nothing = [](const std::string& where) {
    return badInput("{}: contains no surface node", where);
  };
  NodeSet selected;
  selectPlaces(selected, selection, surface, mesh,
               [&](const char* place) { return nothing(key + "." + place); });
  for (const std::string& group : selection.groups) {
    const NodeSet& nodes = groupNamed(mesh, group, key + ".group");
    select(
        selected, surface, [&](std::int32_t node) { return contains(nodes, node); },
        [&] { return nothing(fmt::format("{}.group: \"{}\"", key, group)); });
  }
  sortUnique(selected);
  return selected;
}

NodeSet movableOf(const ActiveSelection& selection, const Mesh& mesh, const NodeSet& surface,
                  const NodeSet& fixed) {
  const std::string key = fmt::format("active \"{}\": surface", selection.name);
  // Leave out fixed nodes without an error if others remain, because a selected surface may extend
  // beyond the movable part.
  const NodeSet selected = selectOnSurface(*selection.surface, key, mesh, surface);
  NodeSet movable;
  std::set_difference(selected.begin(), selected.end(), fixed.begin(), fixed.end(),
                      std::back_inserter(movable));
  if (movable.empty())
    throw badInput("{}: contains only fixed nodes ({}); move it, or fix fewer nodes", key,
                   counted(selected.size(), "node"));
  return movable;
}

/// Returns the surface triangles with three selected corners (ActiveSelection::surface).
std::vector<std::int32_t> trianglesOf(const ActiveSelection& selection, const Mesh& mesh) {
  const std::string key = fmt::format("active \"{}\": surface", selection.name);
  const NodeSet selected = selectOnSurface(*selection.surface, key, mesh, surfaceNodes(mesh));
  std::vector<std::int32_t> triangles;
  for (std::size_t t = 0; t < mesh.surface.size(); ++t)
    if (std::ranges::all_of(mesh.surface[t], [&](auto node) { return contains(selected, node); }))
      triangles.push_back(static_cast<std::int32_t>(t));
  if (triangles.empty())
    throw badInput(
        "{}: contains {} of the surface, but not all three corners of any triangle; make it larger",
        key, counted(selected.size(), "node"));
  return triangles;
}

/// Returns one finger per site of a selected surface.
std::vector<ActiveSelection> sitesOf(const ActiveSelection& selection, const Mesh& mesh,
                                     const std::vector<std::int32_t>& triangles,
                                     const NodeSet& fixed, const Scene& scene) {
  const std::vector<Eigen::Vector3d> sites = atLine(selection.lines.of("radius"), [&] {
    return sitesOn(mesh, triangles, fixed, selection.radius, siteDistance(scene, selection.radius));
  });
  if (sites.empty())
    throw badInput(
        "active \"{}\": surface: a finger of radius {:.4g} m would rest on fixed nodes everywhere "
        "in it; move it, or fix fewer nodes",
        selection.name, selection.radius);
  std::vector<ActiveSelection> fingers;
  for (const Eigen::Vector3d& site : sites) {
    ActiveSelection& one = fingers.emplace_back(selection);
    one.name = fmt::format("{}-{}", selection.name, fingers.size() - 1);
    one.area = selection.name;
    one.surface.reset();
    one.near = site;
  }
  return fingers;
}

/// Returns one finger per probe place of a selected surface.
std::vector<ActiveSelection> probesOf(const ActiveSelection& selection, const Mesh& mesh,
                                      const std::vector<std::int32_t>& triangles,
                                      const NodeSet& fixed, const Scene& scene) {
  std::vector<ActiveSelection> fingers;
  for (const auto& [place, displacement] :
       probePlaces(mesh, triangles, fixed, selection.radius, scene.workspace.radius, scene.contact,
                   scene.accuracy.probes)) {
    ActiveSelection& one = fingers.emplace_back(selection);
    one.name = fmt::format("{}-probe-{}", selection.name, fingers.size() - 1);
    one.surface.reset();
    one.near = place;
    one.probe_of = selection.name;
    one.probe = displacement;
  }
  return fingers;
}

// ---- patches --------------------------------------------------------------------------------

std::int32_t nearestOf(const NodeSet& candidates, const Mesh& mesh, const Eigen::Vector3d& x) {
  return *std::ranges::min_element(
      candidates, {}, [&](std::int32_t node) { return (mesh.nodes[node] - x).squaredNorm(); });
}

std::int32_t selectActiveNode(const ActiveSelection& selection, const Mesh& mesh,
                              const NodeSet& surface) {
  if (selection.near) {
    const std::int32_t node = nearestOf(surface, mesh, *selection.near);
    const double distance = (mesh.nodes[node] - *selection.near).norm();
    if (distance > boundingBox(mesh).diagonal().norm())
      throw badInput(
          "active \"{}\": near = {} is {:.4g} m away from the nearest surface node, more than the "
          "body is wide; is it given in length_unit?",
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

ActivePatch selectFinger(const ActiveSelection& selection, const Mesh& mesh, const NodeSet& fixed) {
  const Finger finger =
      selection.near ? fingerNear(fmt::format("active \"{}\": near", selection.name), mesh,
                                  *selection.near, selection.radius)
                     : Finger{mesh.nodes[selectActiveNode(selection, mesh, surfaceNodes(mesh))],
                              selection.radius};
  ActivePatch patch = fingerPatch(selection.name, mesh, fixed, finger);
  patch.probe = selection.probe;
  return patch;
}

/// Returns the vertices of the surface together with its mid-edge nodes.
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
        "active \"{}\": its radius of {:.4g} m contains only {} (edges are {:.4g} m on average); a "
        "weighted average needs at least 3; make radius larger, or refine the mesh there",
        patch.name, radius, counted(patch.nodes.size(), "movable surface node"),
        measure(mesh).mean_edge);
  const std::vector<BumpIntegral> integrals =
      bumpIntegrals(mesh, mesh.nodes[patch.node], radius, /*derivatives=*/false);
  std::vector<double> weights;
  for (const std::int32_t node : patch.nodes) weights.push_back(integrals[node].value);
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  // With quadratic shape functions, single weights and even their sum may be negative.
  if (!(sum > 0))
    throw badInput(
        "active \"{}\": the weights of its {} nodes do not have a positive sum; make radius larger",
        patch.name, patch.nodes.size());
  for (double& weight : weights) weight /= sum;
  return weights;
}

// ---- [[region]] ------------------------------------------------------------------------------

constexpr std::uint16_t nowhere = std::numeric_limits<std::uint16_t>::max();

const std::vector<std::int32_t>& tetrahedraOfGroup(const std::string& name, const Mesh& mesh) {
  const auto& elements = entryNamed(
      mesh.element_groups, name, fmt::format("region.group: there is no volume group \"{}\"", name),
      "physical groups of volumes");
  if (elements.empty()) throw badInput("region.group: \"{}\" has no tetrahedron", name);
  return elements;
}

/// Returns the tetrahedra of the group and those with a centroid in a box or sphere, sorted.
std::vector<std::int32_t> tetrahedraOf(const Region& region, const Mesh& mesh) {
  std::vector<std::int32_t> elements;
  if (!region.group.empty())
    elements =
        atLine(region.lines.of("group"), [&] { return tetrahedraOfGroup(region.group, mesh); });
  const auto addThoseIn = [&](const auto& places, const char* key) {
    for (const auto& place : places) {
      const std::size_t before = elements.size();
      for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e)
        if (isIn(place, middleOf(mesh, e))) elements.push_back(static_cast<std::int32_t>(e));
      if (elements.size() == before)
        throw badInputAt(
            region.lines.of(key),
            "region.{}: contains no centre of a tetrahedron; the mesh extends from {} to {} m, and "
            "edges are {:.3g} m on average",
            key, placeText(boundingBox(mesh).min()), placeText(boundingBox(mesh).max()),
            measure(mesh).mean_edge);
    }
  };
  addThoseIn(region.boxes, "box");
  addThoseIn(region.spheres, "sphere");
  sortUnique(elements);
  return elements;
}

/// Returns the element vectors that give the material's fibre directions (Material::fiber_field),
/// or null if it uses none.
const std::vector<Eigen::Vector3d>* fieldOf(const Material& material, const Mesh& mesh) {
  if (material.fiber_field.empty()) return nullptr;
  return &entryNamed(
      mesh.element_vectors, material.fiber_field,
      fmt::format("material.fiber: there are no element vectors \"{}\"", material.fiber_field),
      "element vectors");
}

}  // namespace

NodeSet selectFixed(const FixedSelection& selection, const Mesh& mesh) {
  const NodeSet nodes = allNodes(mesh);
  const Eigen::AlignedBox3d box = boundingBox(mesh);
  const auto nothing = [&](const char* key) {
    return badInputAt(selection.lines.of(key),
                      "fixed.{} selects no node; the mesh extends from {} to {} m", key,
                      placeText(box.min()), placeText(box.max()));
  };
  NodeSet fixed;
  for (const HalfSpace& half : selection.half_spaces)
    select(
        fixed, nodes, [&](std::int32_t node) { return isIn(half, box, mesh.nodes[node]); },
        [&] { return nothing(half.below ? "below" : "above"); });
  selectPlaces(fixed, selection, nodes, mesh, nothing);
  for (const std::string& group : selection.groups) {
    const NodeSet in_group =
        atLine(selection.lines.of("group"), [&] { return groupNamed(mesh, group, "fixed.group"); });
    fixed.insert(fixed.end(), in_group.begin(), in_group.end());
  }
  for (const std::int32_t node : selection.nodes) {
    if (node >= mesh.vertices())
      throw badInputAt(selection.lines.of("nodes"),
                       "fixed.nodes: there is no node {}; the mesh has nodes 0 to {}", node,
                       mesh.vertices() - 1);
    fixed.push_back(node);
  }
  addNodesBetween(selection.nodes, mesh, fixed);
  sortUnique(fixed);
  return fixed;
}

std::vector<ActiveSelection> expandSurfaces(const Scene& scene, const Mesh& mesh,
                                            const NodeSet& fixed) {
  PALPATE_ASSERT(std::ranges::is_sorted(fixed), "the fixed nodes must be sorted");
  const NodeSet surface = surfaceNodes(mesh);
  std::vector<ActiveSelection> expanded, probes;
  const auto expand = [&](const ActiveSelection& selection) {
    if (!selection.surface) return (selection.isProbe() ? probes : expanded).push_back(selection);
    if (selection.tool == ToolKind::finger) {
      const std::vector<std::int32_t> triangles = trianglesOf(selection, mesh);
      std::ranges::move(sitesOf(selection, mesh, triangles, fixed, scene),
                        std::back_inserter(expanded));
      std::ranges::move(probesOf(selection, mesh, triangles, fixed, scene),
                        std::back_inserter(probes));
      return;
    }
    for (const std::int32_t node : movableOf(selection, mesh, surface, fixed)) {
      ActiveSelection& one = expanded.emplace_back(selection);
      one.name = fmt::format("{}-{}", selection.name, node);
      one.surface.reset();
      one.node = node;
    }
  };
  for (const ActiveSelection& selection : scene.active)
    atLine(selection.lines.of("name"), [&] { expand(selection); });
  std::ranges::move(probes, std::back_inserter(expanded));
  std::set<std::string> names;
  for (const ActiveSelection& one : scene.active)
    if (one.surface && one.tool == ToolKind::finger) names.insert(one.name);  // name of its area
  for (const ActiveSelection& one : expanded)
    if (!names.insert(one.name).second)
      throw badInputAt(
          one.lines.of("name"),
          "two active nodes are called \"{}\"; one of them is part of a surface: rename the other",
          one.name);
  return expanded;
}

ActivePatch selectPatch(const ActiveSelection& selection, const Mesh& mesh, const NodeSet& fixed) {
  PALPATE_ASSERT(!selection.surface, "areas must be split into sites");
  if (selection.tool == ToolKind::finger) return selectFinger(selection, mesh, fixed);
  const NodeSet surface = surfaceNodes(mesh);
  const bool weighted = selection.tool == ToolKind::weighted_average;
  ActivePatch patch;
  patch.name = selection.name;
  patch.node = selectActiveNode(selection, mesh, surface);
  const Eigen::Vector3d& center = mesh.nodes[patch.node];
  for (const std::int32_t node : weighted ? withMidEdgeNodes(surface, mesh) : allNodes(mesh)) {
    const bool within = (mesh.nodes[node] - center).squaredNorm() <=
                        selection.radius * selection.radius * on_the_sphere;
    // Always include the active node itself. With a radius of 0, round-off could exclude it.
    if (node == patch.node || (within && !contains(fixed, node))) patch.nodes.push_back(node);
  }
  PALPATE_ASSERT(contains(patch.nodes, patch.node), "a tool must move its active node");
  if (weighted) patch.weights = weightsOf(patch, mesh, selection.radius);
  return patch;
}

std::vector<std::uint16_t> selectRegions(const std::vector<Region>& regions, const Mesh& mesh) {
  const bool has_rest = regions.front().isRest();
  std::vector<std::uint16_t> region_of(mesh.tetrahedra.size(), nowhere);
  for (std::size_t r = has_rest ? 1 : 0; r < regions.size(); ++r)
    for (const std::int32_t element : tetrahedraOf(regions[r], mesh)) {
      if (region_of[element] != nowhere)
        throw badInputAt(
            regions[r].lines.of("group"),
            "region.group: {} is in \"{}\" and in \"{}\"; a tetrahedron has one material",
            placeOf(mesh, element), regions[region_of[element]].name(), regions[r].name());
      region_of[element] = static_cast<std::uint16_t>(r);
    }
  // Tetrahedra outside all regions belong to [material]. Without a [material] there must be none.
  const auto rest = std::ranges::find(region_of, nowhere);
  if (rest == region_of.end() && has_rest)
    throw badInputAt(
        regions.front().lines.table,
        "[material]: the regions cover the whole body and leave no tetrahedron for it; remove it");
  if (rest != region_of.end() && !has_rest)
    throw badInputAt(regions.front().lines.table,
                     "[[region]]: {} is in no region; write a [material] for the rest of the body",
                     placeOf(mesh, rest - region_of.begin()));
  std::ranges::replace(region_of, nowhere, std::uint16_t{0});
  return region_of;
}

bool hasFibers(const std::vector<Region>& regions) {
  return std::ranges::any_of(regions, [](const Region& region) {
    return !region.material.fibers.empty() || !region.material.fiber_field.empty();
  });
}

std::vector<std::array<Eigen::Vector3d, 2>> selectFibers(
    const std::vector<Region>& regions, const std::vector<std::uint16_t>& region_of,
    const Mesh& mesh) {
  if (!hasFibers(regions)) return {};
  PALPATE_ASSERT(region_of.size() == mesh.tetrahedra.size(), "each tetrahedron must have a region");
  std::vector<const std::vector<Eigen::Vector3d>*> fields;
  const auto line = [&](std::size_t region) { return regions[region].lines.of("fiber"); };
  for (std::size_t r = 0; r < regions.size(); ++r)
    fields.push_back(atLine(line(r), [&] { return fieldOf(regions[r].material, mesh); }));
  std::vector<std::array<Eigen::Vector3d, 2>> fibers(
      region_of.size(), {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
  for (std::size_t e = 0; e < region_of.size(); ++e) {
    const Material& material = regions[region_of[e]].material;
    if (const auto* field = fields[region_of[e]]) {
      if ((*field)[e].isZero(0))
        throw badInputAt(line(region_of[e]), "material.fiber: \"{}\" is zero or missing in {}",
                         material.fiber_field, placeOf(mesh, e));
      fibers[e][0] = (*field)[e].stableNormalized();
    }
    std::ranges::copy(material.fibers, fibers[e].begin());
  }
  return fibers;
}

}  // namespace palpate
