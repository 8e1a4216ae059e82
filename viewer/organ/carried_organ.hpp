#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/mesh/mesh.hpp"
#include "common/space/space_table.hpp"

namespace palpate {

/// Limit of the number of vertices, because a page draws with indices of 16 bits.
inline constexpr std::size_t most_carried_vertices = 65536;

/// A touchable part of an organ: an active node with its patch, or a surface that a finger touches
/// anywhere.
struct CarriedTouch {
  std::string name;
  std::vector<std::int32_t> spaces;  ///< indices in CarriedOrgan::spaces; one, or one per site
  double finger_radius = 0;          ///< m; 0: no finger
  /// m, rest position of the active node. Unused for a finger, which rests wherever it touches.
  Eigen::Vector3d rest = Eigen::Vector3d::Zero();
  /// collocation points of a surface, m (AreaField::collocationPointsOf)
  std::vector<Eigen::Vector3d> collocation_points = {};
};

/// Deformed shapes of all solved points, as sums of the same few modes.
struct CarriedShapes {
  /// Orthonormal displacement modes. Each row is one mode and holds the displacement of every
  /// vertex, [mode][vertex][axis]. The number of modes is a multiple of three, because
  /// DisplacementField interpolates the shares as triples.
  std::vector<float> modes;
  std::size_t mode_count = 0;
  /// Factors of the modes in the shape of each solved point, one list per space: [point][mode], m;
  /// zero for unsolved points.
  std::vector<std::vector<float>> shares;
};

/// The part of a dataset that a page needs to answer touches. It can be encoded as one block of
/// bytes, in which forces keep nearly all digits and shapes are as accurate as a picture needs.
///
/// The bytes contain patch.finger, lattice and splits of each space, and the tags and equilibria of
/// its points. Energy, force and stiffness are exact; numbers that only a finger has (the
/// derivatives with respect to its place, and stiffness_by_p) are rounded to 37 significant bits.
struct CarriedOrgan {
  std::string name;                             ///< name of the scene
  double max_force = 0;                         ///< N, force limit of the scene
  bool has_fibers = false;                      ///< SpaceTable::has_fibers of all spaces
  std::vector<Eigen::Vector3d> vertices;        ///< m, of the surface at rest
  std::vector<Triangle> triangles;              ///< indices in `vertices`; normals point outward
  std::vector<std::int32_t> touch_of_triangle;  ///< index in `touches`; -1: cannot be touched
  std::vector<CarriedTouch> touches;
  std::vector<SpaceTable> spaces;
  CarriedShapes shapes;
};

/// Encodes an organ as little-endian bytes.
std::string encode(const CarriedOrgan& organ);
/// Decodes the bytes of encode(), from the same sources: a page contains both its organ and the
/// code that decodes it. Error if the bytes are cut off. Nothing else is checked, because a browser
/// unpacks the bytes only if they have the checksum that zlib stored with them.
CarriedOrgan decode(std::string_view bytes);

}  // namespace palpate
