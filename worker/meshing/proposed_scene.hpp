#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/mesh/mesh.hpp"
#include "worker/meshing/guessed_unit.hpp"

namespace palpate {

/// A proposed scene, from which the user can start.
struct ProposedScene {
  std::string toml;                  ///< commented, lengths in the unit of the mesh
  std::vector<std::string> choices;  ///< the choices and their reasons, sentences for the user
  /// The warnings that remain (warningsOf).
  std::vector<std::string> warnings = {};
};

/// Proposes the fixed nodes, the tool and the workspace for a mesh (metres, as readGmsh read it
/// with `unit`).
///
/// The fixed part is a node group whose name suggests it, or else the broader end along the longest
/// axis. The tool is a finger that touches the whole surface outside the fixed part. Several radii
/// are tried: the proposal is the first that causes no avoidable warning, or else the one with the
/// fewest warnings. The workspace is as deep as the force of the device pushes into soft tissue.
///
/// `mesh_file` is the name of the mesh, which lies next to the scene. Error (bad input), as from
/// resolve(), if the mesh allows no scene.
ProposedScene proposedScene(const Mesh& mesh, const std::string& name, const std::string& mesh_file,
                            const GuessedUnit& unit);

/// Checks the file name of a mesh, because a scene quotes it. Error (bad input), which names
/// `option`, if the name contains a quote, a backslash or a control character.
void refuseMeshName(const std::filesystem::path& file, const char* option);

}  // namespace palpate
