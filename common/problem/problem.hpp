#pragma once

#include "common/base/bytes32.hpp"
#include "common/mesh/mesh.hpp"
#include "common/problem/pressure_slots.hpp"
#include "common/scene/scene.hpp"
#include "common/space/active_patch.hpp"
#include "common/space/lattice.hpp"

namespace palpate {

/// Smallest and largest plausible extent of a body, metres.
inline constexpr double smallest_body = 1e-3, largest_body = 10;

/// A scene together with its mesh, with the scene's selectors resolved to nodes. A problem
/// determines its dataset completely.
struct Problem {
  Scene scene;
  Mesh mesh;                             ///< quadratic if the displacement is P2
  std::vector<std::uint16_t> region_of;  ///< per tetrahedron, index into Scene::regions
  /// Two unit fibre directions per tetrahedron; a direction that the material does not have is the
  /// zero vector. Empty if no material has fibres.
  std::vector<std::array<Eigen::Vector3d, 2>> fibers;
  std::vector<std::int32_t> fixed;  ///< sorted
  std::vector<ActivePatch> active;  ///< one configuration space each, in scene order
  /// Numbering of the pressures in NodalFields; computed from the other members. If no material
  /// around a node has a pressure, the pressure in the node's slot is zero and not an unknown.
  PressureSlots pressures;
};

/// Returns the size of NodalFields::encode() of an equilibrium of this problem.
std::size_t fieldsBytes(const Problem& problem);

// The part of the nodal fields that a dataset stores (Storage).

/// Returns the nodes with stored displacements, sorted.
std::vector<std::int32_t> storedNodes(const Scene& scene, const Mesh& mesh);

/// Returns the number of stored pressures.
std::size_t storedPressures(const Problem& problem);

/// Returns the bytes of the stored fields of one configuration, before compression.
std::size_t storedBytes(const Problem& problem);

/// Checks everything that resolve() guarantees about a problem, for problems from other sources.
/// Error (bad input) if a guarantee is violated.
void checkProblem(const Problem& problem);

/// Number of parts into which one lattice spacing is divided, so that a lattice can also hold
/// points between the uniform ones.
inline constexpr std::int32_t lattice_divisions = 1024;

/// Returns the uniform lattice of a scene. Its spacing is divided (lattice_divisions) if refinement
/// or probes may add points between the uniform ones. The lattice of a finger covers only the
/// finger's reach. The lattice of a probe (ActivePatch::probe) is the origin alone.
Lattice uniformLattice(const Scene& scene, const ActivePatch& patch = {});

/// Returns the number of probes, exact solutions off the lattice, in one space. It is 1 for a probe
/// place of an area, 0 for a site of an area that has probe places, and accuracy.probes for all
/// other spaces.
std::int32_t probesIn(const Scene& scene, std::size_t space);

/// Computes Problem::pressures of a problem that checkProblem accepts.
PressureSlots pressureSlots(const Problem& problem);

/// Resolves the selectors of a scene on its mesh, which must be finished (finishMesh). Error (bad
/// input) that names the key of the scene if
/// - the mesh is larger than 10 m or smaller than 1 mm (the message suggests a plausible
///   length_unit);
/// - a selector selects nothing, or a group or node does not exist;
/// - the selector of an active node selects only fixed nodes;
/// - the fixed set is empty or contains every node;
/// - a tetrahedron is in no region or in two;
/// - a region names a group that does not exist, or contains no tetrahedron;
/// - a material takes its fibres from element vectors that the mesh lacks or that are zero;
/// - an active node is fixed or not on the surface, or `near` is farther from the surface than the
///   body is wide;
/// - a rigid patch and the fixed nodes together contain all nodes, or a weighted patch has fewer
///   than three nodes;
/// - a finger is as wide as the body, rests mostly on fixed nodes, or is so small that its surface
///   needs more than max_sites sites;
/// - a component of the mesh can move freely: its fixed nodes and the nodes that it shares with
///   other held components lie on one line, or there are no such nodes;
/// - the workspace radius exceeds 3 bounding-box diagonals.
///
/// Input that is doubtful but can be computed is not an Error; warningsOf() reports it
/// (problem_warnings.hpp). An active `surface` is replaced by one active node per selected vertex,
/// or for a finger by its sites and, after all other entries, its probe places. The scene in the
/// result contains these entries, as if a user had written them one by one. Tests whether a node
/// lies within a radius allow 5e-13 of the radius for round-off. With P2 displacement the mesh
/// first gets its mid-edge nodes (`mesh` has none). selection.hpp describes the selectors.
Problem resolve(Scene scene, Mesh mesh);

/// Reads a scene file and its mesh (readScene, readGmsh) and resolves the scene. A mesh in another
/// format is an Error that mentions `palpate mesh`.
Problem loadProblem(const std::filesystem::path& scene_file);

/// Encode a problem as the bytes that workers get, and decode these bytes. They are the Protobuf
/// message palpate.wire.Problem with a deterministic field order.
///
/// In the decoded scene, the mesh path is reduced to its file name, and metres_per_unit is 1. Node
/// sets, weights, regions and fibres are not selected again, but taken from the bytes and checked
/// by checkProblem(). Mid-edge nodes are computed again. Element groups and vectors are not
/// encoded, because nothing needs them after resolve(). Error (failure) if the bytes are damaged,
/// or if encodeProblem() would encode the decoded problem differently.
std::string encodeProblem(const Problem& problem);
Problem decodeProblem(std::string_view bytes);

/// Returns the id of a build: two problems with the same id have the same configurations. The id
/// covers materials, discretisation, gravity, workspace, accuracy, nodes, tetrahedra with their
/// regions and fibres, fixed nodes, and the names, nodes, weights, places and reach of the active
/// patches.
///
/// The id leaves out everything that does not influence configurations, so that results stay valid
/// if it changes. It leaves out the scene's name, file paths, selectors (but not the selected
/// nodes), names of groups, the unit of the files, [storage], and the device (but not its effect on
/// the workspace).
ContentId problemId(const Problem& problem);

}  // namespace palpate
