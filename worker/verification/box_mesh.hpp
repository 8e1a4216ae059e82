#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "common/mesh/mesh.hpp"

/// Boxes cut into tetrahedra in code: what verification, tests and benchmarks compute on. All are
/// finished (finishMesh), positively oriented, linear, in metres, and the same on every machine.
/// Node groups "xmin", "xmax", "ymin", "ymax", "zmin" and "zmax" hold the nodes of the six sides.
namespace palpate {

/// The box [0, size] cut into cells[0] x cells[1] x cells[2] bricks of six Kuhn tetrahedra each.
/// (cells[0]+1)(cells[1]+1)(cells[2]+1) nodes, x fastest: node (i, j, k) has number i +
/// (cells[0]+1) (j + (cells[1]+1) k).
Mesh boxMesh(const Eigen::Vector3d& size, const std::array<int, 3>& cells);

/// The cube [0, edge]^3 with n cells per edge: (n+1)^3 nodes, 6 n^3 tetrahedra.
Mesh cubeMesh(double edge, int n);

/// boxMesh whose inner nodes are moved at random by up to `amount` of a cell in each coordinate;
/// the sides stay flat. amount < 0.25 keeps every tetrahedron positive.
Mesh distortedBoxMesh(const Eigen::Vector3d& size, const std::array<int, 3>& cells,
                      double amount = 0.2, std::uint32_t seed = 1);

}  // namespace palpate
