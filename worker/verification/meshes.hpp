#pragma once

#include <Eigen/Core>

#include "common/mesh/mesh.hpp"

/// Bodies cut into tetrahedra in code: what verification, tests and benchmarks compute on. All are
/// finished (finishMesh), positively oriented, linear, in metres, and the same on every machine.
///
/// Node groups "xmin", "xmax", "ymin", "ymax", "zmin" and "zmax" hold the nodes of the six sides of
/// a box; "first" and "last" those of the two ends of the layers of everything else. Flat faces on
/// curved bodies: the error of the geometry is of second order in the element size.
namespace palpate::verification {

/// The box [0, size] cut into cells[0] x cells[1] x cells[2] bricks of six Kuhn tetrahedra each.
/// (cells[0]+1)(cells[1]+1)(cells[2]+1) nodes, x fastest: node (i, j, k) has number i +
/// (cells[0]+1) (j + (cells[1]+1) k).
Mesh boxMesh(const Eigen::Vector3d& size, const std::array<int, 3>& cells);

/// The cube [0, edge]^3 with n cells per edge: (n+1)^3 nodes, 6 n^3 tetrahedra.
Mesh cubeMesh(double edge, int n);

/// boxMesh whose inner nodes are moved at random by up to `amount` of a cell in each coordinate;
/// the sides stay flat. amount < 0.25 keeps every tetrahedron positive.
Mesh distortedBoxMesh(const Eigen::Vector3d& size, const std::array<int, 3>& cells,
                      double amount = 0.2);

/// Cook's membrane: the corners (0,0) (48,44) (48,60) (0,44) mm, n x n cells in one layer of
/// `thickness` metres along z, whose triangles share the diagonal from upper left to lower right.
/// "first" and "last" are its faces.
Mesh cookMesh(int n, double thickness);

/// Cylinder around the z axis in `n` rings, 6 n facets around. "first": z = 0, "last": z = length.
Mesh cylinderMesh(double radius, double length, int n, int layers);

/// A quarter (x, y >= 0) of a tube around the z axis: n cells around and n through the wall, in one
/// layer of `thickness` along z. Node group "inner" is its inner wall.
Mesh quarterTubeMesh(double inner, double outer, double thickness, int n);

/// An octant (x, y, z >= 0) of a ball: the cube [0, 1]^3 with n cells per edge, its cubical shells
/// moved onto spheres. Node k <= n is on the x axis; "outside" is the sphere, "xmin", "ymin" and
/// "zmin" are the flat sides.
Mesh ballOctantMesh(double radius, int n);

/// An octant (x, y, z >= 0) of a hollow sphere: n^2 triangles on the wall, n layers. "first" is the
/// inner wall.
Mesh sphereOctantMesh(double inner, double outer, int n);

}  // namespace palpate::verification
