#pragma once

#include <Eigen/Core>
#include <filesystem>

#include "common/mesh/mesh.hpp"
#include "tests/verification/meshes.hpp"

/// The small bodies that tests and benchmarks share. All are complete (finishMesh), positively
/// oriented, in metres, and the same on every machine. Node groups "xmin", "xmax", "ymin", "ymax",
/// "zmin" and "zmax" hold the nodes of the six sides.
namespace palpate::test {

using verification::boxMesh;
using verification::cubeMesh;
using verification::distortedBoxMesh;

/// A slender beam along x, 100 x 20 x 20 mm: 99 nodes, 240 tetrahedra.
Mesh beamMesh();

/// A rounded, slightly bent organ of about 20 x 14 x 10 cm around the origin: (n+1)^3 nodes, 6 n^3
/// tetrahedra; by default 125 nodes and 384 tetrahedra. Tests fix side xmin.
Mesh blobMesh(int n = 4);

/// One tetrahedron with corners at the origin and at the three unit vectors times `edge`.
Mesh tetrahedronMesh(double edge = 1.0);

/// Returns both bodies as one mesh, not connected. The nodes of the second follow those of the
/// first. Keeps only the groups of the first.
Mesh together(Mesh first, const Mesh& second);

/// The mesh moved by a vector in metres.
Mesh moved(Mesh mesh, const Eigen::Vector3d& by);

/// Merges coincident nodes into the one with the lowest index.
Mesh welded(Mesh mesh);

/// Writes the mesh as Gmsh 2.2 or 4.1 ASCII, coordinates with 17 digits, each node group as a
/// physical group of points of the same name. Reading it back gives the same nodes, tetrahedra and
/// groups. Throws if the file cannot be written.
void writeGmsh22(const Mesh& mesh, const std::filesystem::path& file);
void writeGmsh41(const Mesh& mesh, const std::filesystem::path& file);

}  // namespace palpate::test
