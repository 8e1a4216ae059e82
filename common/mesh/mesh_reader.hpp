#pragma once

#include <filesystem>

#include "common/mesh/mesh.hpp"

/// The mesh format that scenes take; `palpate mesh` makes it of others (worker/meshing).
namespace palpate {

/// Reads a Gmsh .msh file, version 2.2 or 4.1, ASCII, with either kind of line end, and finishes it
/// (finishMesh, refuseOverlaps). Coordinates become metres (toMetres). Volume elements must be
/// tetrahedra of 4 nodes, or of 10 whose edges are straight: their mid-edge nodes are dropped,
/// since Mesh adds its own (addMidEdgeNodes). Point, line and surface elements are read for the
/// physical groups they name and otherwise ignored. An element that version 2.2 repeats for each of
/// its physical groups is read once.
///
/// Physical groups of every dimension become node groups under their name, those of dimension 3
/// also element groups; without a name as "point 3", "curve 3", "surface 3" or "volume 3", since
/// Gmsh counts each dimension on its own. Groups with the same name are united. $ElementData of
/// three components become element vectors under their first string tag, zero where the data name
/// no tetrahedron; of several time steps the first.
///
/// Error (bad input) for a missing, truncated, binary, other-version, partitioned or inconsistent
/// file, or a curved edge, naming file and line. Places in errors are in the unit of the file.
Mesh readGmsh(const std::filesystem::path& file, double metres_per_unit = 1.0);

/// The same from text; `source` names it in errors.
Mesh parseGmsh(std::string text, const std::string& source, double metres_per_unit = 1.0);

}  // namespace palpate
