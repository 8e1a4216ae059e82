#pragma once

#include <filesystem>
#include <string>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// Reads a legacy VTK file (.vtk, ASCII, versions 1 to 5) with an unstructured grid and finishes it
/// (finishMesh). Coordinates become metres (toMetres). Cells of type 10 (tetrahedron) and 24
/// (quadratic tetrahedron, straight edges; its mid-edge nodes are dropped) are read, vertices,
/// lines and surface cells passed over, other volume cells refused.
///
/// CELL_DATA of three components become element vectors under their name. An integer array "region"
/// of one component makes element groups that are called like its numbers: "3". Everything else is
/// passed over.
///
/// Error (bad input) for a missing, truncated, binary or inconsistent file, naming file and line.
Mesh readVtk(const std::filesystem::path& file, double metres_per_unit = 1.0);

/// The same from text; `source` names it in errors.
Mesh parseVtk(std::string text, const std::string& source, double metres_per_unit = 1.0);

}  // namespace palpate
