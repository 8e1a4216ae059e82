#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/content_id.hpp"
#include "common/lattice.hpp"
#include "common/mesh.hpp"
#include "common/scene.hpp"

namespace palpate {

/// The tool's contact: the active node and every node that moves rigidly with it.
struct ActivePatch {
  std::string name;
  std::int32_t node = -1;              ///< the active node
  std::vector<std::int32_t> nodes;     ///< sorted, contains `node`, disjoint from the fixed nodes
};

/// A scene with its mesh and with its selectors resolved to nodes: everything that determines a dataset.
struct Problem {
  Scene scene;
  Mesh mesh;
  std::vector<std::int32_t> fixed;     ///< sorted
  std::vector<ActivePatch> active;     ///< one configuration space each, in the order of the scene
};

/// Resolves the selectors of a scene on its mesh. Error (bad input), naming the scene's key, when the fixed set is
/// empty or contains every node, when a selector selects nothing, when an active node is fixed or not on the surface, when a mesh
/// is larger than 10 m or smaller than 1 mm (a unit mistaken: the message says which length_unit would make it plausible), when the
/// workspace radius exceeds 3 bounding-box diagonals, or when two pieces of the mesh are not connected and one has no fixed node.
Problem resolve(Scene scene, Mesh mesh);

/// readScene + read the mesh (by file ending) + resolve.
Problem loadProblem(const std::filesystem::path& scene_file);

/// The problem as bytes (Protobuf message palpate.wire.Problem, deterministic field order) and back. The worker gets
/// it in this form. decodeProblem checks everything that resolve checks about numbers; Error when damaged.
std::string encodeProblem(const Problem& problem);
Problem decodeProblem(std::string_view bytes);

/// Name of a build: the id of encodeProblem(problem). Two scenes with the same id give the same dataset. It covers the
/// physics, lattice and mesh; not file paths.
ContentId problemId(const Problem& problem);

}  // namespace palpate
