#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>

#include "common/mesh.hpp"

/// The small bodies that tests and benchmarks share. All are finished (finishMesh), positively oriented, in
/// metres, and the same on every machine. Node groups "xmin", "xmax", "ymin", "ymax", "zmin" and "zmax" hold
/// the nodes of the six sides.
namespace palpate::test {

/// The box [0, size] cut into cells[0] x cells[1] x cells[2] bricks of six Kuhn tetrahedra each.
/// (cells[0]+1)(cells[1]+1)(cells[2]+1) nodes, x fastest: node (i, j, k) has number i + (cells[0]+1) (j +
/// (cells[1]+1) k).
Mesh boxMesh(const Eigen::Vector3d& size, const std::array<int, 3>& cells);

/// The cube [0, edge]^3 with n cells per edge: (n+1)^3 nodes, 6 n^3 tetrahedra.
Mesh cubeMesh(double edge, int n);

/// boxMesh whose inner nodes are moved at random by up to `amount` of a cell in each coordinate; the sides
/// stay flat. amount < 0.25 keeps every tetrahedron positive.
Mesh distortedBoxMesh(const Eigen::Vector3d& size, const std::array<int, 3>& cells, double amount = 0.2,
                      std::uint32_t seed = 1);

/// A slender beam along x, 100 x 20 x 20 mm: 99 nodes, 240 tetrahedra.
Mesh beamMesh();

/// A rounded, slightly bent organ of about 20 x 14 x 10 cm around the origin: (n+1)^3 nodes, 6 n^3
/// tetrahedra; the default has 125 nodes and 384 tetrahedra. Side xmin is the one to fix.
Mesh blobMesh(int n = 4);

/// One tetrahedron: the corner at the origin and the three unit vectors times `edge`.
Mesh tetrahedronMesh(double edge = 1.0);

/// Writes the mesh as Gmsh 2.2 or 4.1 ASCII, coordinates with 17 digits, each node group as a physical group
/// of points under its name. Reading it back gives the same nodes, tetrahedra and groups. Error when the file
/// cannot be written.
void writeGmsh22(const Mesh& mesh, const std::filesystem::path& file);
void writeGmsh41(const Mesh& mesh, const std::filesystem::path& file);

}  // namespace palpate::test
