#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/mesh/mesh.hpp"
#include "common/space/space_table.hpp"

namespace palpate {

/// Limit of the vertices that a page can draw: its indices have 16 bits.
inline constexpr std::size_t most_carried_vertices = 65536;

/// A touchable part of an organ: an active node with its patch, or a surface that a finger touches
/// anywhere.
struct CarriedTouch {
  std::string name;
  std::vector<std::int32_t>
      spaces;  ///< into CarriedOrgan::spaces; a single one, or the sites of the surface
  double finger_radius = 0;  ///< m; 0: no finger
  /// m, rest position of the active node. Unused for a finger, which rests wherever it touches.
  Eigen::Vector3d rest = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d>
      collocation_points;  ///< m, of a surface: see AreaField::collocationPointsOf
};

/// Deformed shapes of all solved points, as sums of the same few modes.
struct CarriedShapes {
  /// Orthonormal rows of the displacements of all vertices, [mode][vertex][axis]. The number of
  /// modes is a multiple of three.
  std::vector<float> modes;
  std::size_t mode_count = 0;
  /// Per space: [point][mode], m; zero for unsolved points.
  std::vector<std::vector<float>> shares;
};

/// The part of a dataset that a page needs to answer touches, in one block of bytes. Forces keep
/// nearly all digits; shapes are as accurate as a picture needs.
///
/// Spaces carry patch.finger, lattice, splits, and the tags and equilibria of their points. Energy,
/// force and stiffness keep every bit; data of fingers only are rounded to 37 significant bits.
struct CarriedOrgan {
  std::string name;                             ///< name of the scene
  double max_force = 0;                         ///< N, of the scene: larger forces were not solved
  std::vector<Eigen::Vector3d> vertices;        ///< m, of the surface at rest
  std::vector<Triangle> triangles;              ///< into vertices, normals outward
  std::vector<std::int32_t> touch_of_triangle;  ///< into touches; -1: cannot be touched
  std::vector<CarriedTouch> touches;
  std::vector<SpaceTable> spaces;
  CarriedShapes shapes;
};

/// Describes the first inconsistency as a clause for an error message ("triangle 7 has a corner
/// 900"); empty if there is none. Checks all data that are used later: indices of vertices,
/// touches, spaces, points and cells, and that all numbers of a computation are finite.
std::string faultOf(const CarriedOrgan& organ);

/// Encodes an organ as little-endian bytes. They begin with a version; only code of the same
/// version decodes them.
std::string encode(const CarriedOrgan& organ);
/// Decodes an organ. Error if the bytes are no organ, of another version, cut off, or inconsistent
/// (faultOf). A returned organ can always be touched, whatever the bytes were.
CarriedOrgan decode(std::string_view bytes);

}  // namespace palpate
