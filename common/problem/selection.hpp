#pragma once

#include "common/mesh/mesh.hpp"
#include "common/mesh/node_set.hpp"
#include "common/scene/scene.hpp"
#include "common/space/active_patch.hpp"

/// What the tables of a scene select on its mesh: the nodes that are held, that can be touched and
/// that move with the tool, and the regions of the body and their fibres. Errors are bad input and
/// name the key or the active node.
namespace palpate {

/// The nodes that [fixed] selects: mid-edge nodes too, by their position, by their group, or
/// because both vertices of their edge are listed in `nodes`. Error when a selector selects nothing
/// or a group or node does not exist.
NodeSet selectFixed(const FixedSelection& selection, const Mesh& mesh);

/// The [[active]] tables of a scene with every `surface` replaced by one table for each vertex of
/// the surface that it selects and that is not fixed, in the order of their numbers, called
/// NAME-NODE; radius and tool are those of the table. For a finger instead one table for each site
/// (sitesOn), called NAME-0, NAME-1, ..., `near` the site, with the area NAME; triangles belong to
/// the surface whose three corners are selected. Behind all of them come the places where such
/// areas are measured (probePlaces), scene.accuracy.probes each, called NAME-probe-0, and so on.
/// Error when a selector holds no vertex of the surface, when all that are selected are fixed, when
/// a group does not exist, or when two active nodes have one name then.
std::vector<ActiveSelection> expandSurfaces(const Scene& scene, const Mesh& mesh,
                                            const NodeSet& fixed);

/// The patch of an [[active]] table without `surface`. A rigid one holds all nodes within the
/// radius, inner ones and mid-edge nodes too; a weighted one those of the surface, with their
/// weights (ActivePatch::weights); a finger is centred at the point of the surface that is nearest
/// to `near` (finger.hpp). Fixed nodes are left out. Error when the node does not exist or
/// is not a vertex of the surface, when `near` is far from the body, or when fewer than three nodes
/// are left to be averaged.
ActivePatch selectPatch(const ActiveSelection& selection, const Mesh& mesh, const NodeSet& fixed);

/// Which region each tetrahedron is in: that of its group, or of the box or sphere that its middle
/// is in. Error (bad input), naming the key, when a region names an element group that the mesh
/// does not have (listing those it has), when a group, box or sphere is empty, when a tetrahedron
/// is in two regions, or in none although there is no [material], or when none is left for
/// [material].
std::vector<std::uint16_t> selectRegions(const std::vector<Region>& regions, const Mesh& mesh);

/// The fibres of each tetrahedron as Problem::fibers. Error (bad input) when the mesh has no
/// element vectors of the name that a material gives (listing those it has), or a zero one where
/// one is needed.
std::vector<std::array<Eigen::Vector3d, 2>> selectFibers(
    const std::vector<Region>& regions, const std::vector<std::uint16_t>& region_of,
    const Mesh& mesh);

/// Whether some material has fibres.
bool hasFibers(const std::vector<Region>& regions);

}  // namespace palpate
