#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/mesh/mesh.hpp"

/// The bodies of the verification problems that are not boxes (worker/verification/box_mesh.hpp).
/// Finished, linear, positively oriented; node groups "first" and "last" hold the nodes of the two
/// ends of the layers. Flat faces on curved bodies: the error of the geometry is of second order in
/// the element size.
namespace palpate::verification {

/// Triangles over numbered points of the plane.
struct Grid {
  std::vector<Eigen::Vector2d> points;
  std::vector<Triangle> triangles;  ///< counter-clockwise
};

/// [0, 1]^2 cut into n x m cells of two triangles each, whose common edge runs from lower left to
/// upper right.
Grid squareGrid(int n, int m);
/// The triangle (0,0) (1,0) (0,1) cut into n^2 equal ones.
Grid triangleGrid(int n);
/// The unit disc in n rings around the point 0, ring k of 6 k points.
Grid discGrid(int n);

/// `grid` in `layers` layers of prisms, each cut into three tetrahedra. `position` maps (x, y, z),
/// x and y of the grid and z in [0, 1] across the layers, to metres.
Mesh layeredMesh(const Grid& grid, int layers,
                 const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& position);

/// Cook's membrane: the corners (0,0) (48,44) (48,60) (0,44) mm, n x n cells in one layer of
/// `thickness` metres along z, whose triangles share the diagonal from upper left to lower right.
/// "first" and "last" are its faces.
Mesh cookMesh(int n, double thickness);

/// Cylinder around the z axis in `n` rings, 6 n facets around. "first": z = 0, "last": z = length.
Mesh cylinderMesh(double radius, double length, int n, int layers);

/// A quarter (x, y >= 0) of a tube around the z axis: n cells around and n through the wall, in one
/// layer of `thickness` along z. Node group "inner" is its inner wall.
Mesh quarterTubeMesh(double inner, double outer, double thickness, int n);

/// An octant (x, y, z >= 0) of a hollow sphere: n^2 triangles on the wall, n layers. "first" is the
/// inner wall.
Mesh sphereOctantMesh(double inner, double outer, int n);

}  // namespace palpate::verification
