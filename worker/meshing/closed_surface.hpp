#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// Triangles as a file has them; lengths in the unit of the file.
struct TriangleSoup {
  std::vector<Eigen::Vector3d> points = {};
  std::vector<Triangle> triangles = {};  ///< 0-based
};

/// Reads what convert_mesh.py writes of a surface. Error when it is not that.
TriangleSoup readTriangles(const std::filesystem::path& file);

/// The closed surface of one body, which may have cavities; lengths in the unit of the file.
struct ClosedSurface {
  std::vector<Eigen::Vector3d> points = {};
  /// Every edge has two; normals point out of the tissue, those of cavities into them.
  std::vector<Triangle> triangles = {};
  std::vector<Eigen::Vector3d> cavities = {};  ///< a point in each
  double volume = 0;                           ///< of the tissue
  double area = 0;
  std::vector<std::string> notes = {};  ///< what was put right, sentences for people
};

/// Which bodies of a file are meant.
enum class Bodies : std::uint8_t {
  only,    ///< there must be one
  largest  ///< the one of the largest volume, with its cavities; what else is there is left out
};

/// How fine a body is wanted.
struct Fineness {
  std::int32_t nodes = 1000;  ///< as near to it as a few tries get
  /// Length of the edges in the unit of the surface; then `nodes` does not count.
  std::optional<double> size = {};
};

/// Length of edges with which a body of this volume and surface gets so many nodes, roughly: sqrt 2
/// per cube of the edge inside, and on the surface half a layer more.
double edgeFor(double volume, double area, double nodes);

/// Makes a closed surface of triangles. Put right, with a note: corners that lie within 1e-6 of the
/// bounding box's diagonal of each other are one, and within 1e-4 corners at open edges that this
/// closes; triangles of which two corners are one, and repeated ones, are left out; triangles are
/// turned until neighbours face the same side and all face outward. A shell inside of a body is a
/// cavity; one narrower than an edge of elements of this `fineness` is filled.
///
/// Error (bad input), which begins with `source` and tells how many, where the first is and what to
/// do: no triangles, or far too large coordinates; edges with one triangle (open) or with more than
/// two; one side only; no volume; several bodies, with their sizes; triangles that cut each other
/// (self_intersections.hpp). Error with the exit code of an interrupt when this process is
/// interrupted.
ClosedSurface closedSurface(TriangleSoup soup, const std::string& source, Bodies bodies,
                            const Fineness& fineness = {});

}  // namespace palpate
