#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/units.hpp"
#include "common/mesh/mesh.hpp"

namespace palpate {

/// A scene to begin with.
struct ProposedScene {
  std::string toml;                        ///< commented, lengths in the unit of the mesh
  std::vector<std::string> choices;        ///< what was chosen and why, sentences for people
  std::vector<std::string> warnings = {};  ///< of warningsOf(): what could not be avoided
};

/// Proposes how a mesh (metres, as readGmsh read it with `unit`) is held and touched: fixed is a
/// group whose name says so, or the broader end along the longest axis; a finger touches all of the
/// rest; the workspace is as deep as the device's force reaches in soft tissue. Of several sizes of
/// the finger the first without a warning is taken.
///
/// `mesh_file` is the name of the mesh beside the scene, `doubt` what is not sure of the unit (or
/// empty). Error (bad input) where no scene can be made of the mesh, as resolve() says it.
ProposedScene proposedScene(const Mesh& mesh, const std::string& name, const std::string& mesh_file,
                            const LengthUnit& unit, const std::string& doubt);

/// A scene names the mesh beside it in quotes: Error (bad input) that names the option for a file
/// whose name has a quote, a backslash or a control character.
void refuseMeshName(const std::filesystem::path& file, const char* option);

}  // namespace palpate
