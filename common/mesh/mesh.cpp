#include "common/mesh/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/base/joined_sets.hpp"
#include "common/base/number_text.hpp"

namespace palpate {
namespace {

/// Shape measure below which a tetrahedron counts as flat: its stiffness would be dominated by
/// round-off.
constexpr double degenerate_shape = 1e-6;

/// Corners of the faces of a positively oriented tetrahedron, with outward normals.
constexpr std::array<std::array<int, 3>, 4> faces_of_tetrahedron = {
    {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

void refuseBrokenNumbers(const Mesh& mesh, const std::string& source) {
  if (mesh.tetrahedra.empty())
    throw badInput(
        "{}: has no tetrahedra; mesh the volume (gmsh -3, or palpate mesh for a closed surface). "
        "If there are physical groups, put the volume into one, because Gmsh then saves only "
        "elements in groups",
        source);
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (!(mesh.nodes[n].array().abs() <= farthest_node).all())
      throw badInput(
          "{}: node {} (counted from 0) has a coordinate that is not finite, or beyond "
          "{:g}: is the unit right?",
          source, n, farthest_node);
  const auto n_nodes = static_cast<std::int32_t>(mesh.nodes.size());
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    Tetrahedron nodes = mesh.tetrahedra[e];
    std::ranges::sort(nodes);
    if (nodes.front() < 0 || nodes.back() >= n_nodes)
      throw badInput(
          "{}: tetrahedron {} (counted from 0) uses a node that does not exist (there are {})",
          source, e, n_nodes);
    if (std::ranges::adjacent_find(nodes) != nodes.end())
      throw badInput("{}: {} uses a node twice", source, placeOf(mesh, e, ""));
  }
}

void dropOrphans(Mesh& mesh) {
  constexpr std::int32_t unused = -1;
  std::vector<std::int32_t> new_number(mesh.nodes.size(), unused);
  for (const Tetrahedron& tetrahedron : mesh.tetrahedra)
    for (const std::int32_t node : tetrahedron) new_number[node] = 0;
  std::int32_t kept = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (new_number[n] != unused) {
      mesh.nodes[kept] = mesh.nodes[n];
      new_number[n] = kept++;
    }
  mesh.dropped_nodes += static_cast<std::int32_t>(mesh.nodes.size()) - kept;
  mesh.nodes.resize(kept);
  for (Tetrahedron& tetrahedron : mesh.tetrahedra)
    for (std::int32_t& node : tetrahedron) node = new_number[node];
  for (auto& [name, nodes] : mesh.node_groups) {
    for (std::int32_t& node : nodes) node = new_number[node];
    std::erase(nodes, unused);
    sortUnique(nodes);
  }
}

void refuseBrokenGroups(const Mesh& mesh, const std::string& source) {
  const auto refuse = [&](const auto& groups, std::size_t end, const char* what) {
    for (const auto& [name, members] : groups)
      for (const std::int32_t member : members)
        if (member < 0 || at(member) >= end)
          throw badInput("{}: group \"{}\" uses a {} that does not exist ({} of {})", source, name,
                         what, member, end);
  };
  refuse(mesh.node_groups, mesh.nodes.size(), "node");
  refuse(mesh.element_groups, mesh.tetrahedra.size(), "tetrahedron");
}

/// Gives every tetrahedron positive orientation. Meshing programs use either orientation, and some
/// mix both in one file. If this makes tetrahedra overlap at a face, deriveSurface refuses the
/// mesh.
void orient(Mesh& mesh, const std::string& source) {
  mesh.reoriented_tetrahedra = 0;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    if (const double shape = shapeOf(mesh, e); !(shape >= degenerate_shape))
      throw badInput(
          "{}: {} is degenerate: its shape measure is {:.2g} (1 is regular, 0 flat); re-mesh, "
          "or let gmsh optimise (-optimize_netgen)",
          source, placeOf(mesh, e, ""), shape);
    if (sixVolume(mesh, e) > 0) continue;
    std::swap(mesh.tetrahedra[e][2], mesh.tetrahedra[e][3]);
    ++mesh.reoriented_tetrahedra;
  }
}

struct Face {
  Triangle sorted;  ///< sorted nodes, equal for all tetrahedra that share the face
  std::size_t element;
  int local;
  /// Parity of the permutation that sorts the nodes. Tetrahedra on the two sides of a face have
  /// different parities.
  bool even;
};

Triangle nodesOf(const Mesh& mesh, std::size_t element, int face) {
  const Tetrahedron& nodes = mesh.tetrahedra[element];
  const auto& [a, b, c] = faces_of_tetrahedron[face];
  return {nodes[a], nodes[b], nodes[c]};
}

std::vector<Face> sortedFaces(const Mesh& mesh) {
  std::vector<Face> faces;
  faces.reserve(4 * mesh.tetrahedra.size());
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e)
    for (int f = 0; f < 4; ++f) {
      Triangle t = nodesOf(mesh, e, f);
      // Rotating the lowest node to the front is an even permutation. Then at most one swap is
      // left.
      std::rotate(t.begin(), std::ranges::min_element(t), t.end());
      const bool even = t[1] < t[2];
      std::ranges::sort(t);
      faces.push_back({t, e, f, even});
    }
  std::ranges::sort(faces, {}, [](const Face& f) { return std::tie(f.sorted, f.element); });
  return faces;
}

void deriveSurface(Mesh& mesh, const std::string& source) {
  const std::vector<Face> faces = sortedFaces(mesh);
  std::vector<std::pair<std::size_t, int>> outer;
  for (std::size_t first = 0, next; first < faces.size(); first = next) {
    next = first + 1;
    while (next < faces.size() && faces[next].sorted == faces[first].sorted) ++next;
    const std::size_t count = next - first;
    if (count > 2)
      throw badInput(
          "{}: {} tetrahedra share one face, among them {}; at most two can share a face", source,
          count, placeOf(mesh, faces[first].element, ""));
    if (count == 2 && faces[first].even == faces[first + 1].even)
      throw badInput(
          "{}: {} and tetrahedron {} lie on the same side of the face they share: the mesh folds "
          "over itself there, or one of them is repeated; re-mesh",
          source, placeOf(mesh, faces[first].element, ""), faces[first + 1].element);
    if (count == 1) outer.emplace_back(faces[first].element, faces[first].local);
  }
  // Order the triangles by element, as in the file, because datasets store them in this order.
  std::ranges::sort(outer);
  mesh.surface.clear();
  for (const auto& [element, local] : outer) mesh.surface.push_back(nodesOf(mesh, element, local));
}

Edge edgeBetween(std::int32_t a, std::int32_t b) { return {std::min(a, b), std::max(a, b)}; }

/// Returns the edges of all tetrahedra, each once, ascending.
std::vector<Edge> edgesOf(const Mesh& mesh) {
  std::vector<Edge> edges;
  edges.reserve(6 * mesh.tetrahedra.size());
  for (const Tetrahedron& t : mesh.tetrahedra)
    for (const auto& [a, b] : tetrahedron_edges) edges.push_back(edgeBetween(t[a], t[b]));
  sortUnique(edges);
  return edges;
}

}  // namespace

Eigen::AlignedBox3d boundingBox(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& node : mesh.nodes) box.extend(node);
  return box;
}

std::string placeText(const Eigen::Vector3d& x, int figures) {
  return fmt::format("({})", vectorText(x, figures));
}

Eigen::Vector3d middleOf(const Mesh& mesh, std::size_t element) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const std::int32_t node : mesh.tetrahedra[element]) middle += mesh.nodes[node] / 4;
  return middle;
}

std::string placeOf(const Mesh& mesh, std::size_t element, const char* unit) {
  return fmt::format("tetrahedron {} (counted from 0, centre at {}{})", element,
                     placeText(middleOf(mesh, element)), unit);
}

double sixVolume(const Mesh& mesh, std::size_t element) {
  const Tetrahedron& t = mesh.tetrahedra[element];
  const Eigen::Vector3d& a = mesh.nodes[t[0]];
  return (mesh.nodes[t[1]] - a).cross(mesh.nodes[t[2]] - a).dot(mesh.nodes[t[3]] - a);
}

double shapeOf(const Mesh& mesh, std::size_t element) {
  const Tetrahedron& t = mesh.tetrahedra[element];
  double squared_edges = 0;
  for (const auto& [a, b] : tetrahedron_edges)
    squared_edges += (mesh.nodes[t[a]] - mesh.nodes[t[b]]).squaredNorm();
  // Four coincident nodes count as flat. The quotient would be 0/0.
  if (squared_edges == 0) return 0;
  return 12 * std::pow(std::abs(sixVolume(mesh, element)) / 2, 2.0 / 3.0) / squared_edges;
}

NodeSet surfaceNodes(const Mesh& mesh) {
  NodeSet nodes;
  nodes.reserve(3 * mesh.surface.size());
  for (const Triangle& triangle : mesh.surface)
    nodes.insert(nodes.end(), triangle.begin(), triangle.end());
  sortUnique(nodes);
  return nodes;
}

NodeSet allNodes(const Mesh& mesh) { return countUp(mesh.nodes.size()); }

std::vector<NodeSet> piecesOf(const Mesh& mesh) {
  JoinedSets joined(mesh.tetrahedra.size());
  const std::vector<Face> faces = sortedFaces(mesh);
  for (std::size_t f = 1; f < faces.size(); ++f)
    if (faces[f].sorted == faces[f - 1].sorted)
      joined.join(static_cast<std::int32_t>(faces[f].element),
                  static_cast<std::int32_t>(faces[f - 1].element));
  std::vector<NodeSet> pieces;
  std::vector<std::size_t> number(mesh.tetrahedra.size());
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const std::size_t lowest = at(joined.lowest(static_cast<std::int32_t>(e)));
    if (lowest == e) {
      number[e] = pieces.size();
      pieces.emplace_back();
    }
    NodeSet& piece = pieces[number[lowest]];
    piece.insert(piece.end(), mesh.tetrahedra[e].begin(), mesh.tetrahedra[e].end());
    if (!mesh.edges.empty())
      piece.insert(piece.end(), mesh.mid_edge_nodes[e].begin(), mesh.mid_edge_nodes[e].end());
  }
  for (NodeSet& piece : pieces) sortUnique(piece);
  return pieces;
}

std::string curvedEdge(const std::vector<Eigen::Vector3d>& nodes,
                       const std::array<std::int32_t, 10>& tetrahedron) {
  constexpr double tolerance = 1e-6;
  for (std::size_t e = 0; e < tetrahedron_edges.size(); ++e) {
    const Eigen::Vector3d &a = nodes[tetrahedron[tetrahedron_edges[e][0]]],
                          &b = nodes[tetrahedron[tetrahedron_edges[e][1]]];
    const double off = (nodes[tetrahedron[4 + e]] - 0.5 * (a + b)).norm() / (b - a).norm();
    // The negation also refuses NaN, which an edge of length 0 gives.
    if (!(off <= tolerance))
      return fmt::format(
          "its edge at {} is curved: the mid-edge node is off the middle by {:.2g} of the edge's "
          "length; curved edges are not supported",
          placeText(a / 2 + b / 2), off);
  }
  return {};
}

std::int32_t midEdgeNode(const Mesh& mesh, std::int32_t a, std::int32_t b) {
  const Edge edge = edgeBetween(a, b);
  const auto found = std::lower_bound(mesh.edges.begin(), mesh.edges.end(), edge);
  if (found == mesh.edges.end() || *found != edge) return -1;
  return mesh.vertices() + static_cast<std::int32_t>(found - mesh.edges.begin());
}

void addMidEdgeNodes(Mesh& mesh) {
  PALPATE_ASSERT(mesh.edges.empty() && mesh.mid_edge_nodes.empty(),
                 "the mesh must not be quadratic already");
  mesh.edges = edgesOf(mesh);
  for (const auto& [a, b] : mesh.edges)
    mesh.nodes.emplace_back(0.5 * (mesh.nodes[a] + mesh.nodes[b]));
  for (const Tetrahedron& tetrahedron : mesh.tetrahedra) {
    auto& middle = mesh.mid_edge_nodes.emplace_back();
    std::ranges::transform(tetrahedron_edges, middle.begin(), [&](const auto& edge) {
      return midEdgeNode(mesh, tetrahedron[edge[0]], tetrahedron[edge[1]]);
    });
  }
  for (auto& [name, nodes] : mesh.node_groups) {
    const NodeSet vertices = nodes;
    // Mid-edge nodes are numbered in the order of the edges, so the group stays sorted.
    for (const auto& [a, b] : mesh.edges)
      if (contains(vertices, a) && contains(vertices, b)) nodes.push_back(midEdgeNode(mesh, a, b));
  }
}

std::vector<Edge> coincidentNodes(const std::vector<Eigen::Vector3d>& nodes, double near) {
  // An oblique direction, along which even the nodes of a regular mesh have different positions.
  const Eigen::Vector3d along = Eigen::Vector3d(0.5129, 0.6427, 0.5691).normalized();
  std::vector<std::int32_t> order = countUp(nodes.size());
  std::vector<double> position;
  for (const Eigen::Vector3d& node : nodes) position.push_back(along.dot(node));
  std::ranges::sort(order, {}, [&](std::int32_t n) { return position[n]; });
  JoinedSets places(nodes.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t k = i + 1; k < order.size() && position[order[k]] - position[order[i]] <= near;
         ++k)
      if ((nodes[order[k]] - nodes[order[i]]).norm() <= near) places.join(order[i], order[k]);
  std::vector<Edge> coincident;
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(nodes.size()); ++n)
    if (const std::int32_t lowest = places.lowest(n); lowest != n)
      coincident.push_back({n, lowest});
  return coincident;
}

bool areCollinear(const NodeSet& nodes, const Mesh& mesh) {
  PALPATE_ASSERT(!nodes.empty(), "at least one node must be given");
  const Eigen::Vector3d& a = mesh.nodes[nodes.front()];
  const std::int32_t far = *std::ranges::max_element(
      nodes, {}, [&](std::int32_t n) { return (mesh.nodes[n] - a).norm(); });
  const Eigen::Vector3d along = (mesh.nodes[far] - a).stableNormalized();
  const double near = 1e-6 * boundingBox(mesh).diagonal().norm();
  return std::ranges::all_of(
      nodes, [&](std::int32_t n) { return (mesh.nodes[n] - a).cross(along).norm() <= near; });
}

MeshQuality measure(const Mesh& mesh) {
  PALPATE_ASSERT(!mesh.tetrahedra.empty(), "a mesh must have a tetrahedron");
  MeshQuality quality;
  quality.worst_shape = std::numeric_limits<double>::infinity();
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    quality.volume += sixVolume(mesh, e) / 6;
    const double shape = shapeOf(mesh, e);
    quality.mean_shape += shape / static_cast<double>(mesh.tetrahedra.size());
    if (shape < near_flat_shape) ++quality.nearly_flat;
    if (shape < quality.worst_shape) {
      quality.worst_shape = shape;
      quality.worst_element = static_cast<std::int32_t>(e);
    }
  }
  const Eigen::AlignedBox3d box = boundingBox(mesh);
  quality.lowest = box.min();
  quality.highest = box.max();
  std::vector<double> lengths;
  for (const auto& [a, b] : edgesOf(mesh))
    lengths.push_back((mesh.nodes[a] - mesh.nodes[b]).norm());
  const auto [shortest, longest] = std::ranges::minmax_element(lengths);
  quality.shortest_edge = *shortest;
  quality.longest_edge = *longest;
  quality.mean_edge =
      std::accumulate(lengths.begin(), lengths.end(), 0.0) / static_cast<double>(lengths.size());
  const std::vector<NodeSet> pieces = piecesOf(mesh);
  PALPATE_ASSERT(!pieces.empty(), "a mesh must have at least one piece");
  quality.pieces = static_cast<std::int32_t>(pieces.size());
  std::vector<bool> seen(mesh.nodes.size());
  for (const NodeSet& piece : pieces)
    for (const std::int32_t node : piece) {
      if (seen[node]) quality.hinges.push_back(node);
      seen[node] = true;
    }
  sortUnique(quality.hinges);
  quality.coincident = coincidentNodes({mesh.nodes.begin(), mesh.nodes.begin() + mesh.vertices()},
                                       coincident_distance * box.diagonal().norm());
  return quality;
}

void finishMesh(Mesh& mesh, const std::string& source) {
  // The first steps check all numbers, so that the later ones can use them unchecked.
  refuseBrokenNumbers(mesh, source);
  refuseBrokenGroups(mesh, source);
  dropOrphans(mesh);
  orient(mesh, source);
  deriveSurface(mesh, source);
  // Without an outer surface the signed volumes would add up to zero, but here all are positive.
  PALPATE_ASSERT(!mesh.surface.empty(), "a mesh needs a surface triangle");
}

}  // namespace palpate
