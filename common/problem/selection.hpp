#pragma once

#include "common/mesh/mesh.hpp"
#include "common/mesh/node_set.hpp"
#include "common/scene/scene.hpp"
#include "common/space/active_patch.hpp"

/// Resolves the tables of a scene on its mesh: fixed nodes, touchable nodes, nodes that move with
/// the tool, and the regions of the body with their fibres. All errors are bad input and name the
/// key or the active node.
namespace palpate {

/// Returns the nodes that [fixed] selects. Mid-edge nodes are selected by position or group like
/// vertices, and also if `nodes` lists both vertices of their edge. Error if a selector selects
/// nothing, or if a group or node does not exist.
NodeSet selectFixed(const FixedSelection& selection, const Mesh& mesh);

/// Returns the [[active]] tables of a scene. Each table with a `surface` is replaced by several
/// tables, one per place.
/// - For a rigid or weighted-average tool there is one table per selected surface vertex that is
///   not fixed, ascending. It is called NAME-NODE and has the radius and tool of the original
///   table.
/// - For a finger there is one table per site (sitesOn), called NAME-0, NAME-1, ..., with the site
///   as `near` and NAME as area. A triangle belongs to the surface if its three corners are
///   selected.
///
/// After these tables come the probe places of the areas (probePlaces), scene.accuracy.probes per
/// area, called NAME-probe-0 and so on. Error if a selector holds no surface vertex, if all
/// selected vertices are fixed, if a group does not exist, or if two active nodes would have the
/// same name.
std::vector<ActiveSelection> expandSurfaces(const Scene& scene, const Mesh& mesh,
                                            const NodeSet& fixed);

/// Returns the patch of an [[active]] table that has no `surface`. The patch of a rigid tool holds
/// all nodes within the radius, including inner and mid-edge nodes. The patch of a weighted-average
/// tool holds the surface nodes within the radius, with their weights (ActivePatch::weights). A
/// finger is centred at the surface point nearest to `near` (finger.hpp). Fixed nodes are left out.
/// Error if the node does not exist or is not a surface vertex, if `near` is far from the body, or
/// if fewer than three nodes are left for the weighted average.
ActivePatch selectPatch(const ActiveSelection& selection, const Mesh& mesh, const NodeSet& fixed);

/// Returns the region of each tetrahedron, given by its group or by the box or sphere that holds
/// its centroid. Error (bad input) that names the key if
/// - a region names an element group that the mesh lacks (the message lists the existing ones);
/// - a group, box or sphere is empty;
/// - a tetrahedron is in two regions, or, in a scene without [material], in none;
/// - no tetrahedron is left for [material].
std::vector<std::uint16_t> selectRegions(const std::vector<Region>& regions, const Mesh& mesh);

/// Returns the fibres of each tetrahedron, as in Problem::fibers. Error (bad input) if the mesh
/// lacks the element vectors that a material names (the message lists the existing ones), or if a
/// vector is zero where one is needed.
std::vector<std::array<Eigen::Vector3d, 2>> selectFibers(
    const std::vector<Region>& regions, const std::vector<std::uint16_t>& region_of,
    const Mesh& mesh);

/// Returns whether some material has fibres.
bool hasFibers(const std::vector<Region>& regions);

}  // namespace palpate
