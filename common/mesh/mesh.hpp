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

/// The two corners of each edge of a tetrahedron, in the order of VTK and of Mesh::mid_edge_nodes.
/// (Gmsh swaps the last two edges.)
inline constexpr std::array<std::array<int, 2>, 6> tetrahedron_edges = {
    {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};

/// Largest allowed magnitude of a coordinate, m, so that products of lengths stay finite.
inline constexpr double farthest_node = 1e12;

/// A tetrahedral mesh in the rest state. Node and element numbers are 0-based indices into these
/// arrays. Nodes and tetrahedra are in the order of the file, but nodes that no tetrahedron uses
/// are dropped. Mid-edge nodes follow the nodes of the file.
struct Mesh {
  std::vector<Eigen::Vector3d> nodes;   ///< rest positions, metres
  std::vector<Tetrahedron> tetrahedra;  ///< positive orientation: (b-a) x (c-a) . (d-a) > 0
  std::vector<Triangle> surface;        ///< faces of exactly one tetrahedron, normals outward
  /// Sorted nodes of each named physical group, of any dimension.
  std::map<std::string, NodeSet> node_groups;
  /// Sorted tetrahedra of each named physical group of dimension 3.
  std::map<std::string, std::vector<std::int32_t>> element_groups;
  /// One vector per tetrahedron, for each name of $ElementData with three components.
  std::map<std::string, std::vector<Eigen::Vector3d>> element_vectors;
  /// The edges of a quadratic mesh (addMidEdgeNodes). Edge e has the mid-edge node vertices() + e.
  std::vector<Edge> edges;  ///< (lower, higher) vertex, ascending
  /// Mid-edge nodes per tetrahedron, in the order of tetrahedron_edges.
  std::vector<std::array<std::int32_t, 6>> mid_edge_nodes;
  std::int32_t vertices() const { return static_cast<std::int32_t>(nodes.size() - edges.size()); }
  std::vector<std::string> unused_names;  ///< names of the file's groups without elements
  std::int32_t dropped_nodes = 0;         ///< nodes of the file that no tetrahedron used
  /// Number of tetrahedra that had negative volume in the file; two nodes of each were swapped.
  std::int32_t reoriented_tetrahedra = 0;
};

/// Returns six times the signed volume of tetrahedron `element`, cubic metres.
double sixVolume(const Mesh& mesh, std::size_t element);

Eigen::AlignedBox3d boundingBox(const Mesh& mesh);  ///< metres

/// Returns the centroid of tetrahedron `element`, metres.
Eigen::Vector3d middleOf(const Mesh& mesh, std::size_t element);

/// Returns "tetrahedron 7 (counted from 0, centre at (X, Y, Z) m)" for errors. The centre helps
/// users to find the element, because the element numbers of the file are not kept.
std::string placeOf(const Mesh& mesh, std::size_t element, const char* unit = " m");
std::string placeText(const Eigen::Vector3d& x, int figures = 6);  ///< "(X, Y, Z)"

/// Returns the vertices on the surface.
NodeSet surfaceNodes(const Mesh& mesh);
/// Returns all nodes, including mid-edge nodes.
NodeSet allNodes(const Mesh& mesh);

/// Returns the nodes of each component of the body. Tetrahedra that share a face belong to one
/// component. Components that touch only at nodes or edges are separate, and each contains the
/// shared nodes. Components are ordered by their first tetrahedron.
std::vector<NodeSet> piecesOf(const Mesh& mesh);

/// Returns the shape measure of tetrahedron `element`, 12 (3|V|)^(2/3) / (sum of squared edge
/// lengths), which is 1 for a regular and 0 for a flat tetrahedron.
double shapeOf(const Mesh& mesh, std::size_t element);

/// Describes a curved edge of a 10-node tetrahedron as a sentence for errors; empty if all edges
/// are straight. An edge is curved if its mid-edge node is off the middle by more than 1e-6 of the
/// edge's length. `tetrahedron` lists the corners, then the mid-edge nodes in the order of
/// tetrahedron_edges.
std::string curvedEdge(const std::vector<Eigen::Vector3d>& nodes,
                       const std::array<std::int32_t, 10>& tetrahedron);

/// Returns the node in the middle of the edge between two vertices of a quadratic mesh, or -1 if
/// there is no such edge.
std::int32_t midEdgeNode(const Mesh& mesh, std::int32_t a, std::int32_t b);

/// Makes a mesh quadratic, with straight edges. The mesh must be linear and finished (finishMesh).
/// Appends the mid-edge nodes in the order of Mesh::edges, and adds each one to the node groups
/// that contain both ends of its edge.
void addMidEdgeNodes(Mesh& mesh);

/// Distance below which two nodes count as coincident, as a fraction of the bounding box diagonal.
/// Coordinates that are written with six digits are no more accurate than this.
inline constexpr double coincident_distance = 1e-6;

/// Returns the nodes that coincide with a node of lower number, each as {node, lowest node that it
/// coincides with}, ascending. Nodes coincide if they are at most `near` metres apart, or joined by
/// a chain of nodes whose distances are at most `near`.
std::vector<Edge> coincidentNodes(const std::vector<Eigen::Vector3d>& nodes, double near);

/// Returns whether the nodes (at least one) lie on one line. A body that is fixed only at collinear
/// nodes can turn around the line.
bool areCollinear(const NodeSet& nodes, const Mesh& mesh);

/// Tetrahedra with a shape measure (shapeOf; 1 regular, 0 flat) below this make the equations
/// ill-conditioned and are the first to invert.
inline constexpr double near_flat_shape = 0.1;

/// Measurements of a mesh that `palpate check` prints.
struct MeshQuality {
  double volume = 0;                                          ///< cubic metres
  Eigen::Vector3d lowest = {0, 0, 0}, highest = {0, 0, 0};    ///< bounding box, metres
  double shortest_edge = 0, mean_edge = 0, longest_edge = 0;  ///< metres
  double worst_shape = 0;                                     ///< smallest shapeOf
  double mean_shape = 0;
  std::int64_t nearly_flat = 0;  ///< number of tetrahedra with a shape below near_flat_shape
  std::int32_t worst_element = -1;
  std::int32_t pieces = 0;       ///< number of components (piecesOf)
  NodeSet hinges;                ///< nodes of more than one component
  std::vector<Edge> coincident;  ///< vertices that coincide with others (coincidentNodes)
};
MeshQuality measure(const Mesh& mesh);

/// Finishes a mesh that a reader has filled with nodes, tetrahedra and node_groups: drops unused
/// nodes, corrects the orientation of elements, refuses unusable meshes and derives the surface.
/// `source` names the file in errors.
///
/// In an element with negative volume two nodes are swapped; reoriented_tetrahedra counts such
/// elements. Error (bad input) for
/// - a mesh without tetrahedra;
/// - indices of nodes or tetrahedra out of range, also in groups;
/// - coordinates that are not finite or exceed farthest_node;
/// - an element with a repeated node, and a degenerate element (shape measure < 1e-6);
/// - a face shared by three tetrahedra, or by two on the same side.
///
/// Errors name an element by its 0-based number and its centre (placeOf). The centre is in the unit
/// of the nodes, which need not be metres yet.
void finishMesh(Mesh& mesh, const std::string& source);

}  // namespace palpate
