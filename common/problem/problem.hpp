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

/// A scene with its mesh and with its selectors resolved to nodes. It determines a dataset
/// completely.
struct Problem {
  Scene scene;
  Mesh mesh;                             ///< quadratic if the displacement is P2
  std::vector<std::uint16_t> region_of;  ///< per tetrahedron, index into Scene::regions
  /// Two unit fibre directions per tetrahedron (zero vectors for missing ones); empty if no
  /// material has fibres.
  std::vector<std::array<Eigen::Vector3d, 2>> fibers;
  std::vector<std::int32_t> fixed;  ///< sorted
  std::vector<ActivePatch> active;  ///< one configuration space each, in scene order
  /// Numbering of the pressures in NodalFields; follows from the other members. If no material
  /// around a node has a pressure, its slot is zero and not an unknown.
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

/// Error (bad input) unless the numbers of the problem satisfy everything that resolve()
/// guarantees.
void checkProblem(const Problem& problem);

/// Divisions of the spacing in lattices that hold more than the uniform points.
inline constexpr std::int32_t lattice_divisions = 1024;

/// Returns the uniform lattice of a scene, with divisions if points or probes may be added to it.
/// The lattice of a finger covers only its reach. The lattice of a probe (ActivePatch::probe) is
/// the origin alone.
Lattice uniformLattice(const Scene& scene, const ActivePatch& patch = {});

/// Returns the number of held-out positions of one space. It is 1 for a probe of an area, 0 for a
/// site of an area with such probes, and accuracy.probes for all others.
std::int32_t probesIn(const Scene& scene, std::size_t space);

/// Computes Problem::pressures of a problem that checkProblem accepts.
PressureSlots pressureSlots(const Problem& problem);

/// Resolves the selectors of a scene on its mesh, which finishMesh has finished. Error (bad input)
/// that names the key of the scene if
/// - the mesh is larger than 10 m or smaller than 1 mm (the message suggests a plausible
///   length_unit);
/// - a selector selects nothing, or only fixed nodes for an active one, or a group or node does not
///   exist;
/// - the fixed set is empty, contains every node, or lies on one line in a component of the mesh;
/// - a tetrahedron is in no region or in two, or a region has no group or no tetrahedron;
/// - a material takes its fibres from element vectors that the mesh lacks or that are zero;
/// - an active node is fixed or not on the surface, or `near` is farther from the surface than the
///   body is wide;
/// - a rigid patch and the fixed nodes are the whole body, or a weighted patch has fewer than three
///   nodes;
/// - a finger is as wide as the body, rests on fixed nodes, or is so small that a surface needs
///   more than max_sites of it;
/// - a component of the mesh has no fixed nodes, and shares with the others no nodes or only nodes
/// on
///   one line;
/// - the workspace radius exceeds 3 bounding-box diagonals.
///
/// Doubtful input that can still be computed is reported by warningsOf (problem_warnings.hpp). An
/// active `surface` is replaced by its nodes, or for a finger by its sites and then its probe
/// places. The scene is changed in the same way, as if they had been written one by one. Distances
/// "within a radius" allow 5e-13 of it for round-off. With P2 displacement the mesh gets its
/// mid-edge nodes first (`mesh` has none). selection.hpp describes the selectors.
Problem resolve(Scene scene, Mesh mesh);

/// readScene + readGmsh + resolve. A mesh in another format is an Error that mentions `palpate
/// mesh`.
Problem loadProblem(const std::filesystem::path& scene_file);

/// Encodes the problem as bytes (Protobuf message palpate.wire.Problem, deterministic field order)
/// and decodes it. Workers get it in this form. The decoded scene is the resolved one: the mesh
/// path is reduced to its file name, and metres_per_unit is 1. Node sets, weights, regions and
/// fibres are taken from the bytes, not selected again, and are checked by checkProblem. Mid-edge
/// nodes are made again. Element groups and vectors are not encoded, since resolve() has used them.
/// Error (failure) if the bytes are damaged, which includes bytes that encodeProblem would write in
/// another way.
std::string encodeProblem(const Problem& problem);
Problem decodeProblem(std::string_view bytes);

/// Id of a build: two problems with the same id have the same configurations. It covers materials,
/// discretisation, gravity, workspace, accuracy, nodes, tetrahedra with their regions and fibres,
/// fixed nodes, and the names, nodes, weights, places and reach of the active patches.
///
/// It leaves out everything without influence on configurations, so that changing it keeps the
/// computed results: the scene's name, file paths, selectors (only the selected nodes count), names
/// of groups, the unit of the files, what is stored, and the device (but its effect on the
/// workspace counts).
ContentId problemId(const Problem& problem);

}  // namespace palpate
