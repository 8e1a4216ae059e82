#pragma once

#include "common/base/bytes32.hpp"
#include "common/mesh/mesh.hpp"
#include "common/problem/pressure_slots.hpp"
#include "common/scene/scene.hpp"
#include "common/space/active_patch.hpp"
#include "common/space/lattice.hpp"

namespace palpate {

/// Extents between which a body is taken for meant, metres.
inline constexpr double smallest_body = 1e-3, largest_body = 10;

/// A scene with its mesh and with its selectors resolved to nodes: everything that determines a
/// dataset.
struct Problem {
  Scene scene;
  Mesh mesh;                             ///< quadratic when the displacement is P2
  std::vector<std::uint16_t> region_of;  ///< per tetrahedron, index into Scene::regions
  /// Per tetrahedron two unit directions (zero vectors where there are fewer); empty when no
  /// material has fibres.
  std::vector<std::array<Eigen::Vector3d, 2>> fibers;
  std::vector<std::int32_t> fixed;  ///< sorted
  std::vector<ActivePatch> active;  ///< one configuration space each, in the order of the scene
  /// The pressures of NodalFields. Where no material around a node has a pressure its slot is zero
  /// and no unknown. Follows from the rest.
  PressureSlots pressures;
};

/// NodalFields::encode() of an equilibrium of this problem.
std::size_t fieldsBytes(const Problem& problem);

// What a dataset keeps of the nodal fields of a configuration (Storage).

/// The nodes whose displacements are stored, sorted.
std::vector<std::int32_t> storedNodes(const Scene& scene, const Mesh& mesh);

/// Number of pressures that are stored.
std::size_t storedPressures(const Problem& problem);

/// Bytes of the stored fields of one configuration, before compression.
std::size_t storedBytes(const Problem& problem);

/// Error (bad input) unless everything holds that resolve() guarantees of a problem's numbers.
void checkProblem(const Problem& problem);

/// Parts that coordinates divide the spacing into where there is more than the uniform lattice.
inline constexpr std::int32_t lattice_divisions = 1024;

/// The uniform lattice of a scene: with divisions when points or probes may be added to it. Of a
/// finger only what its reach holds; of one that measures an area (ActivePatch::probe) the origin.
Lattice uniformLattice(const Scene& scene, const ActivePatch& patch = {});

/// Held-out positions of one space: those of [accuracy], but of a site none where its area is
/// measured at places of its own.
std::int32_t probesIn(const Scene& scene, std::size_t space);

/// Problem::pressures, from what checkProblem accepts.
PressureSlots pressureSlots(const Problem& problem);

/// Resolves the selectors of a scene on its mesh, which finishMesh has finished. Error (bad input),
/// naming the scene's key, when
/// - the mesh is larger than 10 m or smaller than 1 mm (a unit mistaken: the message says which
///   length_unit would be plausible);
/// - a selector selects nothing, or nothing but fixed nodes where they cannot be active, or a group
///   or node does not exist;
/// - the fixed set is empty, contains every node, or lies on one line in a piece of the mesh;
/// - a tetrahedron is in no region or in two, or a region has no group or no tetrahedron;
/// - a material wants fibres from element vectors that the mesh does not have, or that are zero;
/// - an active node is fixed or not on the surface, `near` is farther from the surface than the
///   body is wide, or a rigid patch and the fixed nodes are the whole body, or a weighted one has
///   less than three nodes;
/// - a finger is as wide as the body, rests on what is fixed, or is so small that a surface needs
///   more than max_sites of it;
/// - the mesh has a piece, not connected to the others by a shared node, without fixed nodes;
/// - the workspace radius exceeds 3 bounding-box diagonals.
///
/// What is only doubtful is left to warningsOf (problem_warnings.hpp). An active `surface` is
/// replaced by its nodes, or the sites of a finger and the places where it is probed: in the scene
/// too, as if they had been written one by one, those of probes last. Distances "within a radius"
/// allow 5e-13 of it for round-off. With P2 displacement the mesh gets its mid-edge nodes first
/// (`mesh` has none). selection.hpp says what is selected.
Problem resolve(Scene scene, Mesh mesh);

/// readScene + readGmsh + resolve; another format is an Error that names `palpate mesh`.
Problem loadProblem(const std::filesystem::path& scene_file);

/// The problem as bytes (Protobuf message palpate.wire.Problem, deterministic field order) and
/// back. The worker gets it in this form. The decoded scene is the resolved one: mesh path reduced
/// to its file name, metres_per_unit = 1. Node sets, weights, regions and fibres are those of the
/// bytes, not selected anew, and are checked like resolve's (checkProblem); mid-edge nodes are made
/// again. Element groups and vectors, which have served their purpose, stay behind. Error (failure)
/// when damaged, which includes bytes that encodeProblem would write in another way.
std::string encodeProblem(const Problem& problem);
Problem decodeProblem(std::string_view bytes);

/// Name of a build: two problems with the same id have the same configurations. It covers
/// materials, discretisation, gravity, workspace, accuracy, nodes, tetrahedra, their regions and
/// fibres, fixed nodes, and names, nodes, weights, places and reach of the active patches. It does
/// not cover what has no influence on them, so that a change there does not throw a computation
/// away: the scene's name, file paths, the selectors (only the nodes they select count), names of
/// groups, the unit the files were written in, what is stored, and the device (what it cuts of the
/// workspace counts).
ContentId problemId(const Problem& problem);

}  // namespace palpate
