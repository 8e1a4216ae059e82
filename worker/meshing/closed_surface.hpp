#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// The triangles of a file; lengths in the unit of the file.
struct TriangleSoup {
  std::vector<Eigen::Vector3d> points = {};
  std::vector<Triangle> triangles = {};  ///< 0-based
};

/// Reads a surface file that convert_mesh.py wrote. Error if the file is anything else.
TriangleSoup readTriangles(const std::filesystem::path& file);

/// The closed surface of one body, possibly with cavities; lengths in the unit of the file.
struct ClosedSurface {
  std::vector<Eigen::Vector3d> points = {};
  /// Every edge has two triangles. Normals point out of the tissue, so the normals of a cavity
  /// point into the cavity.
  std::vector<Triangle> triangles = {};
  std::vector<Eigen::Vector3d> cavities = {};  ///< one point inside each cavity
  double volume = 0;                           ///< of the tissue
  double area = 0;
  std::vector<std::string> notes = {};  ///< corrections, sentences for the user
};

/// The body to take from a file that may contain several.
enum class Bodies : std::uint8_t {
  only,    ///< the file must contain one body
  largest  ///< the body of the largest volume, with its cavities; all others are dropped
};

/// Requested fineness of a mesh.
struct Fineness {
  std::int32_t nodes = 1000;  ///< approximate number of nodes, approached in a few tries
  /// Length of the edges in the unit of the surface; replaces `nodes`.
  std::optional<double> size = {};
};

/// Returns the edge length that gives about this number of nodes, in a body of this volume and
/// surface area. Assumes sqrt 2 nodes per cube of the edge length inside, plus half a layer of
/// nodes on the surface.
double edgeFor(double volume, double area, double nodes);

/// Makes a closed surface from the triangles of a file.
///
/// Corrections, each of which adds a note:
/// - Corners are merged if they are at most 1e-6 of the bounding box's diagonal apart.
/// - Corners of open edges are merged up to 1e-4 of the diagonal apart, if that closes edges.
/// - Triangles with two equal corners, and repeated triangles, are dropped.
/// - Triangles are reversed until neighbours face the same side and all face outward.
///
/// A shell inside a body is a cavity. A cavity narrower than an element edge of this `fineness` is
/// filled.
///
/// The following cause an Error (bad input). Its message begins with `source` and gives the number
/// of faults, the place of the first one, and the remedy:
/// - no triangles, or far too large coordinates;
/// - edges with one triangle (open) or with more than two;
/// - a one-sided surface, or no volume;
/// - several bodies (with their sizes);
/// - intersecting triangles (self_intersections.hpp).
///
/// Error with the exit code of an interrupt if this process is interrupted.
ClosedSurface closedSurface(TriangleSoup soup, const std::string& source, Bodies bodies,
                            const Fineness& fineness = {});

}  // namespace palpate
