#pragma once

#include <filesystem>

#include "common/mesh.hpp"

namespace palpate {

/// Reads a Gmsh .msh file, version 2.2 or 4.1, ASCII, and finishes it (finishMesh). Coordinates are multiplied by
/// `metres_per_unit`. Point, line and triangle elements are read for the physical groups they name and otherwise
/// ignored; tetrahedra must be 4-node. Physical groups of every dimension become node groups under their name, or
/// under their number as text when they have none.
///
/// Error (bad input) for a missing, truncated, binary, other-version or inconsistent file, naming file and line.
Mesh readGmsh(const std::filesystem::path& file, double metres_per_unit = 1.0);

}  // namespace palpate
