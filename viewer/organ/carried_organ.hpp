#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/mesh/mesh.hpp"
#include "common/space/space_table.hpp"

namespace palpate {

/// What pictures of a page can number: its indices have 16 bits.
inline constexpr std::size_t most_carried_vertices = 65536;

/// Something of an organ that can be touched: an active node with its patch, or a surface that a
/// finger touches anywhere.
struct CarriedTouch {
  std::string name;
  std::vector<std::int32_t>
      spaces;                ///< one, or the sites of the surface, into CarriedOrgan::spaces
  double finger_radius = 0;  ///< m; 0: no finger
  /// m, of the active node at rest. A finger is at rest wherever it touches.
  Eigen::Vector3d rest = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d>
      collocation_points;  ///< m, of a surface: AreaField::collocationPointsOf
};

/// The deformed shapes of all solved points as sums of the same few modes.
struct CarriedShapes {
  /// Orthonormal rows of the displacements of all vertices, [mode][vertex][axis]; the number of
  /// modes is a multiple of three.
  std::vector<float> modes;
  std::size_t mode_count = 0;
  /// Per space: [point][mode], m; of points that are not solved zero.
  std::vector<std::vector<float>> shares;
};

/// What of a dataset goes into one block of bytes, so that a page can answer without it: forces to
/// the last digits, shapes as well as they are seen.
///
/// Of spaces: patch.finger, lattice, splits, and of points tag and equilibrium. Energy, force and
/// stiffness keep every bit; what only a finger has is rounded to 37 significant bits.
struct CarriedOrgan {
  std::string name;                             ///< of the scene
  double max_force = 0;                         ///< N, of the scene: beyond it nothing was solved
  std::vector<Eigen::Vector3d> vertices;        ///< of the surface at rest, m
  std::vector<Triangle> triangles;              ///< into vertices, normals outward
  std::vector<std::int32_t> touch_of_triangle;  ///< into touches; -1: nothing to feel there
  std::vector<CarriedTouch> touches;
  std::vector<SpaceTable> spaces;
  CarriedShapes shapes;
};

/// What of it contradicts itself, as a clause for errors ("triangle 7 has a corner 900"); empty
/// when nothing does. Looked at is all that is used afterwards: numbers that name vertices,
/// touches, spaces, points and cells, and whether what is computed with is finite.
std::string faultOf(const CarriedOrgan& organ);

/// The same as bytes, little-endian; they begin with a version, which only the same version reads.
std::string encode(const CarriedOrgan& organ);
/// Error when they are no organ, of another version, cut off, or damaged so that faultOf() tells:
/// whatever the bytes are, what is returned can be touched.
CarriedOrgan decode(std::string_view bytes);

}  // namespace palpate
