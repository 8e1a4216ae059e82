#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/dataset/dataset_format.hpp"

namespace palpate {
namespace {

using hdf5::Reader;

constexpr const char *points_path = "/mesh/points", *tetrahedra_path = "/mesh/tetrahedra",
                     *surface_path = "/mesh/surface", *edges_path = "/mesh/edges",
                     *fixed_path = "/mesh/fixed_nodes", *visible_path = "/mesh/surface_nodes",
                     *stored_path = "/mesh/stored_nodes";

template <class Index>
void checkIndices(const Reader& in, const char* path, const Index& values, std::size_t end) {
  for (const std::int32_t value : values)
    if (value < 0 || static_cast<std::size_t>(value) >= end)
      throw in.damaged(path, fmt::format("holds {}, which is not in 0..{}", value,
                                         static_cast<std::int64_t>(end) - 1));
}

/// Reads a list of elements, triangles or edges. Error if a node number is not below `end`.
template <std::size_t n>
std::vector<std::array<std::int32_t, n>> readElements(const Reader& in, const char* path,
                                                      std::size_t end) {
  auto elements = in.readList<std::array<std::int32_t, n>>(path);
  for (const auto& element : elements) checkIndices(in, path, element, end);
  return elements;
}

/// Computes the mid-edge nodes of the mesh and checks that the stored ones are the same.
void readMidEdgeNodes(const Reader& in, Mesh& mesh) {
  const auto edges = readElements<2>(in, edges_path, mesh.nodes.size());
  const std::vector<Eigen::Vector3d> points = mesh.nodes;
  if (edges.size() >= points.size())
    throw in.damaged(edges_path, "has as many edges as nodes, or more");
  mesh.nodes.resize(points.size() - edges.size());
  for (const Tetrahedron& tetrahedron : mesh.tetrahedra)
    checkIndices(in, tetrahedra_path, tetrahedron, mesh.nodes.size());
  addMidEdgeNodes(mesh);
  if (mesh.edges != edges || mesh.nodes != points)
    throw in.damaged(edges_path, "does not match the tetrahedra or their mid-edge nodes");
}

std::vector<std::int32_t> readNodes(const Reader& in, const char* path, std::size_t end) {
  std::vector<std::int32_t> nodes = in.readList<std::int32_t>(path);
  checkIndices(in, path, nodes, end);
  if (!std::ranges::is_sorted(nodes)) throw in.damaged(path, "is not sorted");
  return nodes;
}

/// Reads a list that must equal `expected`.
std::vector<std::int32_t> readDerived(const Reader& in, const char* path,
                                      std::vector<std::int32_t> expected) {
  if (in.readList<std::int32_t>(path) != expected)
    throw in.damaged(path, "does not match the surface and the scene");
  return expected;
}

}  // namespace

void writeMesh(hdf5::Writer& out, const Problem& problem) {
  const Mesh& mesh = problem.mesh;
  PALPATE_ASSERT(
      mesh.edges.empty() == (problem.scene.discretization.displacement == DisplacementSpace::p1),
      "only meshes with P2 displacement can have mid-edge nodes");
  out.makeGroup("/mesh");
  out.writeList(points_path, mesh.nodes, "m");
  out.writeList(tetrahedra_path, mesh.tetrahedra, "1");
  out.writeList(surface_path, mesh.surface, "1");
  if (!mesh.edges.empty()) out.writeList(edges_path, mesh.edges, "1");
  out.writeList(fixed_path, problem.fixed, "1");
  out.writeList(visible_path, surfaceNodes(mesh), "1");
  out.writeList(stored_path, storedNodes(problem.scene, mesh), "1");
}

StoredBody readMesh(const Reader& in, const Scene& scene) {
  StoredBody read;
  Mesh& mesh = read.mesh;
  mesh.nodes = in.readList<Eigen::Vector3d>(points_path);
  for (const Eigen::Vector3d& node : mesh.nodes)
    if (!(node.array().abs() <= farthest_node).all())
      throw in.damaged(points_path, "holds a value that is not finite, or far too large");
  mesh.tetrahedra = readElements<4>(in, tetrahedra_path, mesh.nodes.size());
  if (scene.discretization.displacement == DisplacementSpace::p2) readMidEdgeNodes(in, mesh);
  mesh.surface = readElements<3>(in, surface_path, mesh.vertices());
  read.fixed = readNodes(in, fixed_path, mesh.nodes.size());
  read.surface = readDerived(in, visible_path, surfaceNodes(mesh));
  read.stored = readDerived(in, stored_path, storedNodes(scene, mesh));
  return read;
}

}  // namespace palpate
