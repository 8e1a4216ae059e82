#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/units.hpp"
#include "common/mesh/mesh.hpp"

namespace palpate {

/// A proposed scene, as a starting point.
struct ProposedScene {
  std::string toml;                  ///< commented, lengths in the unit of the mesh
  std::vector<std::string> choices;  ///< the choices and their reasons, sentences for the user
  std::vector<std::string> warnings = {};  ///< unavoidable warnings, from warningsOf()
};

/// Proposes the fixed nodes, the tool and the workspace for a mesh (metres, as readGmsh read it
/// with `unit`).
///
/// Fixed is a group with a telling name, or else the broader end along the longest axis. A finger
/// touches all of the rest. Its radius is the first of several sizes that causes no avoidable
/// warning, or else the one with the fewest. The workspace is as deep as the device's force reaches
/// in soft tissue.
///
/// `mesh_file` is the name of the mesh beside the scene, `doubt` the uncertainty of the unit (or
/// empty). Error (bad input), as from resolve(), if the mesh allows no scene.
ProposedScene proposedScene(const Mesh& mesh, const std::string& name, const std::string& mesh_file,
                            const LengthUnit& unit, const std::string& doubt);

/// Checks the name of a mesh file, which a scene quotes. Error (bad input), with the option, if the
/// name contains a quote, a backslash or a control character.
void refuseMeshName(const std::filesystem::path& file, const char* option);

}  // namespace palpate
