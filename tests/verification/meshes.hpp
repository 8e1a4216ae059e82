#pragma once

#include <Eigen/Core>

#include "common/mesh/mesh.hpp"

/// Meshes of simple bodies, made in code for verification, tests and benchmarks. All are finished
/// (finishMesh), positively oriented, linear, in metres, and the same on every machine.
///
/// The node groups of a box are its six sides: "xmin", "xmax", "ymin", "ymax", "zmin" and "zmax".
/// Bodies made of layers have the groups "first" and "last", the outer faces of these two layers.
/// Curved bodies have flat faces, with a geometric error of second order in the element size.
namespace palpate::verification {

/// Returns the box [0, size], divided into cells[0] x cells[1] x cells[2] bricks of six Kuhn
/// tetrahedra each. It has (cells[0]+1)(cells[1]+1)(cells[2]+1) nodes, x fastest: node (i, j, k)
/// has number i + (cells[0]+1) (j + (cells[1]+1) k).
Mesh boxMesh(const Eigen::Vector3d& size, const std::array<int, 3>& cells);

/// Returns the cube [0, edge]^3 with n cells per edge: (n+1)^3 nodes, 6 n^3 tetrahedra.
Mesh cubeMesh(double edge, int n);

/// Returns a boxMesh with inner nodes moved at random by up to `amount` of a cell in each
/// coordinate. The sides stay flat. amount < 0.25 keeps every tetrahedron positive.
Mesh distortedBoxMesh(const Eigen::Vector3d& size, const std::array<int, 3>& cells,
                      double amount = 0.2);

/// Returns Cook's membrane, with corners (0,0) (48,44) (48,60) (0,44) mm and n x n cells in one
/// layer of `thickness` metres along z. The two triangles of a cell share the diagonal from upper
/// left to lower right. The node groups "first" and "last" are the two faces of the layer.
Mesh cookMesh(int n, double thickness);

/// Returns a cylinder around the z axis, with `n` rings of cells and 6 n facets around the axis.
/// The group "first" is at z = 0, "last" at z = length.
Mesh cylinderMesh(double radius, double length, int n, int layers);

/// Returns a quarter (x, y >= 0) of a tube around the z axis: n cells around and n through the
/// wall, in one layer of `thickness` along z. The node group "inner" is the inner wall.
Mesh quarterTubeMesh(double inner, double outer, double thickness, int n);

/// Returns an octant (x, y, z >= 0) of a ball. It is the cube [0, 1]^3 with n cells per edge, where
/// each cubical shell of nodes is moved onto a sphere. Nodes 0 to n lie on the x axis. The group
/// "outside" is the sphere; "xmin", "ymin" and "zmin" are the flat sides.
Mesh ballOctantMesh(double radius, int n);

/// Returns an octant (x, y, z >= 0) of a hollow sphere, in n layers of n^2 triangles each. The
/// group "first" is the inner wall.
Mesh sphereOctantMesh(double inner, double outer, int n);

}  // namespace palpate::verification
