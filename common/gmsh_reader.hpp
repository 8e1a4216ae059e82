#pragma once

#include <filesystem>
#include <string>

#include "common/mesh.hpp"

namespace palpate {

/// Reads a Gmsh .msh file, version 2.2 or 4.1, ASCII, with either kind of line end, and finishes it
/// (finishMesh). Coordinates become metres (toMetres). Point, line and surface elements are read for the
/// physical groups they name and otherwise ignored; volume elements must be 4-node tetrahedra. An element
/// that version 2.2 repeats for each of its physical groups is read once.
///
/// Physical groups of every dimension become node groups under their name; without a name as "point 3",
/// "curve 3", "surface 3" or "volume 3", since Gmsh counts each dimension on its own. Groups with the same
/// name are united.
///
/// Error (bad input) for a missing, truncated, binary, other-version, partitioned or inconsistent file,
/// naming file and line.
Mesh readGmsh(const std::filesystem::path& file, double metres_per_unit = 1.0);

/// The same from text; `source` names it in errors.
Mesh parseGmsh(std::string text, const std::string& source, double metres_per_unit = 1.0);

}  // namespace palpate
