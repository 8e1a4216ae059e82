#pragma once

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <string>

#include "common/mesh/node_set.hpp"

namespace palpate {

using Tetrahedron = std::array<std::int32_t, 4>;
using Triangle = std::array<std::int32_t, 3>;
using Edge = std::array<std::int32_t, 2>;

/// Corners of the six edges of a tetrahedron, in the order of VTK's and of our mid-edge nodes.
/// (Gmsh's order differs in the last two.)
inline constexpr std::array<std::array<int, 2>, 6> tetrahedron_edges = {
    {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};

/// m: no coordinate of a node is larger, so that products of lengths stay finite.
inline constexpr double farthest_node = 1e12;

/// A tetrahedral mesh in the rest state. Node and element numbers are 0-based indices into these
/// arrays, in the order of the file, after nodes that are no corner of a tetrahedron were dropped;
/// mid-edge nodes follow.
struct Mesh {
  std::vector<Eigen::Vector3d> nodes;   ///< rest positions, metres
  std::vector<Tetrahedron> tetrahedra;  ///< positive orientation: (b-a) x (c-a) . (d-a) > 0
  std::vector<Triangle> surface;  ///< faces of exactly one tetrahedron, normals outward; derived
  /// Named physical groups (any dimension) -> sorted nodes.
  std::map<std::string, NodeSet> node_groups;
  /// Named physical groups of dimension 3 -> sorted tetrahedra.
  std::map<std::string, std::vector<std::int32_t>> element_groups;
  /// Named vector per tetrahedron ($ElementData of three components).
  std::map<std::string, std::vector<Eigen::Vector3d>> element_vectors;
  /// Quadratic meshes only (addMidEdgeNodes): the middle of edge e is node vertices() + e.
  std::vector<Edge> edges;  ///< (lower, higher) vertex, ascending
  /// Per tetrahedron, by tetrahedron_edges.
  std::vector<std::array<std::int32_t, 6>> mid_edge_nodes;
  std::int32_t vertices() const { return static_cast<std::int32_t>(nodes.size() - edges.size()); }
  std::int32_t dropped_nodes = 0;  ///< nodes of the file that are no corner of a tetrahedron
  /// Tetrahedra whose node order was turned.
  std::int32_t reoriented_tetrahedra = 0;
};

/// Six times the signed volume of tetrahedron `element`, cubic metres.
double sixVolume(const Mesh& mesh, std::size_t element);

Eigen::AlignedBox3d boundingBox(const Mesh& mesh);  ///< metres

/// Centroid of tetrahedron `element`, metres.
Eigen::Vector3d middleOf(const Mesh& mesh, std::size_t element);

/// "tetrahedron 7 (counted from 0, centre at (X, Y, Z) m)", for errors: the numbers that a file
/// gives its elements are gone.
std::string placeOf(const Mesh& mesh, std::size_t element, const char* unit = " m");
std::string placeText(const Eigen::Vector3d& x);  ///< "(X, Y, Z)"

/// The vertices on the surface.
NodeSet surfaceNodes(const Mesh& mesh);
/// Every node, mid-edge nodes too.
NodeSet allNodes(const Mesh& mesh);

/// The nodes of each piece of the body, in the order of their first tetrahedra. A piece holds
/// together by faces: pieces that meet in a node or an edge alone both have its nodes.
std::vector<NodeSet> piecesOf(const Mesh& mesh);

/// Shape of tetrahedron `element`: 12 (3|V|)^(2/3) / sum of squared edges, 1 for regular, 0 for
/// flat.
double shapeOf(const Mesh& mesh, std::size_t element);

/// Which edge of a 10-node tetrahedron (corners, then mid-edge nodes by tetrahedron_edges) is not
/// straight with its node in the middle, to 1e-6 of its length, as a sentence for errors; empty
/// when all are.
std::string curvedEdge(const std::vector<Eigen::Vector3d>& nodes,
                       const std::array<std::int32_t, 10>& tetrahedron);

/// The node in the middle of the edge between two vertices of a quadratic mesh; -1 when there is no
/// such edge.
std::int32_t midEdgeNode(const Mesh& mesh, std::int32_t a, std::int32_t b);

/// Makes a linear, finished mesh quadratic, with straight edges: appends the mid-edge nodes, in the
/// order of their (lower, higher) end nodes, and adds them to the node groups in which both ends of
/// their edge are.
void addMidEdgeNodes(Mesh& mesh);

/// Nodes no farther from each other than this, in diagonals of the body, are one place: six digits
/// leave no more.
inline constexpr double coincident_distance = 1e-6;

/// The nodes that lie within `near` (m) of one of a lower number, by chains too: {node, the lowest
/// of its place}, ascending.
std::vector<Edge> coincidentNodes(const std::vector<Eigen::Vector3d>& nodes, double near);

/// True when the nodes, at least one, lie on one line: held there a body can turn around it.
bool areCollinear(const NodeSet& nodes, const Mesh& mesh);

/// What `palpate check` prints about a mesh.
struct MeshQuality {
  double volume = 0;                                          ///< cubic metres
  Eigen::Vector3d lowest = {0, 0, 0}, highest = {0, 0, 0};    ///< bounding box, metres
  double shortest_edge = 0, mean_edge = 0, longest_edge = 0;  ///< metres
  double worst_shape = 0;                                     ///< smallest shapeOf
  double mean_shape = 0;
  std::int32_t worst_element = -1;
  std::int32_t pieces = 0;       ///< connected by faces (piecesOf)
  NodeSet hinges;                ///< nodes of more than one piece
  std::vector<Edge> coincident;  ///< vertices that lie on others (coincidentNodes)
};
MeshQuality measure(const Mesh& mesh);

/// Finishes a mesh that a reader filled with nodes, tetrahedra and node_groups: drops orphan nodes,
/// checks and fixes orientation, refuses what cannot be computed on, derives the surface. `source`
/// names the file in errors.
///
/// Orientation: elements of negative volume are turned (reoriented_tetrahedra). Refused: no
/// tetrahedra, indices out of range, groups of tetrahedra that are not there, coordinates that
/// are not finite, an element with a repeated node, a degenerate element (shape measure < 1e-6), a
/// face shared by three tetrahedra or by two on the same side. Elements are named by their 0-based
/// number and the position of their centre in the unit of the nodes, which need not be metres yet,
/// since the numbers that a file gives its elements are gone by then.
void finishMesh(Mesh& mesh, const std::string& source);

}  // namespace palpate
