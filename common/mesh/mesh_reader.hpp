#pragma once

#include <filesystem>

#include "common/mesh/mesh.hpp"

/// Reads Gmsh files, the only mesh format that scenes can use. `palpate mesh` converts other
/// formats (worker/meshing).
namespace palpate {

/// Reads a Gmsh .msh file, version 2.2 or 4.1, ASCII, with LF or CRLF line ends, and finishes it
/// (finishMesh, refuseOverlaps). Coordinates become metres (toMetres). Volume elements must be
/// tetrahedra of 4 nodes, or of 10 nodes with straight edges. The mid-edge nodes of the file are
/// dropped, because addMidEdgeNodes() makes new ones where they are needed. Point, line and surface
/// elements only contribute nodes to their physical groups. An element that version 2.2 repeats for
/// each of its physical groups is kept once.
///
/// Physical groups of every dimension become node groups under their name. Groups of dimension 3
/// also become element groups. Groups without a name are called "point 3", "curve 3", "surface 3"
/// or "volume 3", since Gmsh numbers each dimension separately. Groups with the same name are
/// united; names without elements become Mesh::unused_names. $ElementData of three components
/// become element vectors under their first string tag. Tetrahedra without data get zero vectors.
/// Only the first of several time steps is read.
///
/// Error (bad input) with file and line for a missing, truncated, binary, partitioned or
/// inconsistent file, another version, or a curved edge. Positions in error messages are in the
/// unit of the file.
Mesh readGmsh(const std::filesystem::path& file, double metres_per_unit = 1.0);

/// Reads a mesh from text; `source` names it in errors.
Mesh parseGmsh(std::string text, const std::string& source, double metres_per_unit = 1.0);

}  // namespace palpate
