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

/// Corners of the six edges of a tetrahedron, in the order of VTK and of mid_edge_nodes. (The last
/// two are swapped in Gmsh.)
inline constexpr std::array<std::array<int, 2>, 6> tetrahedron_edges = {
    {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};

/// Largest coordinate of a node, m, so that products of lengths stay finite.
inline constexpr double farthest_node = 1e12;

/// A tetrahedral mesh in the rest state. Node and element numbers are 0-based indices into these
/// arrays. They keep the order of the file, without nodes that no tetrahedron uses. Mid-edge nodes
/// follow.
struct Mesh {
  std::vector<Eigen::Vector3d> nodes;   ///< rest positions, metres
  std::vector<Tetrahedron> tetrahedra;  ///< positive orientation: (b-a) x (c-a) . (d-a) > 0
  std::vector<Triangle> surface;  ///< faces of exactly one tetrahedron, normals outward; derived
  /// Named physical groups of any dimension -> sorted nodes.
  std::map<std::string, NodeSet> node_groups;
  /// Named physical groups of dimension 3 -> sorted tetrahedra.
  std::map<std::string, std::vector<std::int32_t>> element_groups;
  /// Named vector per tetrahedron ($ElementData of three components).
  std::map<std::string, std::vector<Eigen::Vector3d>> element_vectors;
  /// The edges of a quadratic mesh (addMidEdgeNodes). The mid-edge node of edge e is vertices() +
  /// e.
  std::vector<Edge> edges;  ///< (lower, higher) vertex, ascending
  /// Mid-edge nodes per tetrahedron, in the order of tetrahedron_edges.
  std::vector<std::array<std::int32_t, 6>> mid_edge_nodes;
  std::int32_t vertices() const { return static_cast<std::int32_t>(nodes.size() - edges.size()); }
  std::int32_t dropped_nodes = 0;  ///< nodes of the file that no tetrahedron used
  /// Number of tetrahedra with reversed node order.
  std::int32_t reoriented_tetrahedra = 0;
};

/// Returns six times the signed volume of tetrahedron `element`, cubic metres.
double sixVolume(const Mesh& mesh, std::size_t element);

Eigen::AlignedBox3d boundingBox(const Mesh& mesh);  ///< metres

/// Returns the centroid of tetrahedron `element`, metres.
Eigen::Vector3d middleOf(const Mesh& mesh, std::size_t element);

/// Returns "tetrahedron 7 (counted from 0, centre at (X, Y, Z) m)" for errors, since the element
/// numbers of the file are not kept.
std::string placeOf(const Mesh& mesh, std::size_t element, const char* unit = " m");
std::string placeText(const Eigen::Vector3d& x);  ///< "(X, Y, Z)"

/// Returns the vertices on the surface.
NodeSet surfaceNodes(const Mesh& mesh);
/// Returns all nodes, including mid-edge nodes.
NodeSet allNodes(const Mesh& mesh);

/// Returns the nodes of each component of the body, ordered by first tetrahedron. Tetrahedra that
/// share a face are in one component. Components that meet only in nodes or edges each contain
/// these nodes.
std::vector<NodeSet> piecesOf(const Mesh& mesh);

/// Returns the shape of tetrahedron `element`: 12 (3|V|)^(2/3) / sum of squared edges, 1 if regular
/// and 0 if flat.
double shapeOf(const Mesh& mesh, std::size_t element);

/// Describes, as a sentence for errors, an edge of a 10-node tetrahedron with its mid-edge node off
/// the middle by more than 1e-6 of the edge's length; empty if there is none. The tetrahedron lists
/// its corners, then its mid-edge nodes in the order of tetrahedron_edges.
std::string curvedEdge(const std::vector<Eigen::Vector3d>& nodes,
                       const std::array<std::int32_t, 10>& tetrahedron);

/// Returns the node in the middle of the edge between two vertices of a quadratic mesh, or -1 if
/// there is no such edge.
std::int32_t midEdgeNode(const Mesh& mesh, std::int32_t a, std::int32_t b);

/// Makes a linear, finished mesh quadratic with straight edges. Appends the mid-edge nodes in the
/// order of their (lower, higher) end nodes, and adds each to the node groups that contain both
/// ends.
void addMidEdgeNodes(Mesh& mesh);

/// Distance, in diagonals of the body, within which nodes coincide. Coordinates written with six
/// digits are no more accurate.
inline constexpr double coincident_distance = 1e-6;

/// Returns {node, lowest node at its place}, ascending, for every node that lies within `near` (m)
/// of one with a lower number, directly or through a chain of such nodes.
std::vector<Edge> coincidentNodes(const std::vector<Eigen::Vector3d>& nodes, double near);

/// Returns whether the nodes, at least one, lie on one line. A body held there can turn around it.
bool areCollinear(const NodeSet& nodes, const Mesh& mesh);

/// Measurements of a mesh that `palpate check` prints.
struct MeshQuality {
  double volume = 0;                                          ///< cubic metres
  Eigen::Vector3d lowest = {0, 0, 0}, highest = {0, 0, 0};    ///< bounding box, metres
  double shortest_edge = 0, mean_edge = 0, longest_edge = 0;  ///< metres
  double worst_shape = 0;                                     ///< smallest shapeOf
  double mean_shape = 0;
  std::int32_t worst_element = -1;
  std::int32_t pieces = 0;       ///< number of components (piecesOf)
  NodeSet hinges;                ///< nodes of more than one component
  std::vector<Edge> coincident;  ///< vertices that coincide with others (coincidentNodes)
};
MeshQuality measure(const Mesh& mesh);

/// Finishes a mesh that a reader filled with nodes, tetrahedra and node_groups: drops unused nodes,
/// checks and fixes orientation, refuses unusable meshes and derives the surface. `source` names
/// the file in errors.
///
/// The node order of elements with negative volume is reversed (reoriented_tetrahedra). Error (bad
/// input) for
/// - a mesh without tetrahedra;
/// - indices out of range, and groups of tetrahedra that do not exist;
/// - coordinates that are not finite or exceed farthest_node;
/// - an element with a repeated node, and a degenerate element (shape measure < 1e-6);
/// - a face shared by three tetrahedra, or by two on the same side.
///
/// Errors name elements by 0-based number and centre, since the element numbers of the file are not
/// kept. The centre is in the unit of the nodes, which need not be metres yet.
void finishMesh(Mesh& mesh, const std::string& source);

}  // namespace palpate
