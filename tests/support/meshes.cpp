#include "tests/support/meshes.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "common/base/error.hpp"

namespace palpate::test {
namespace {

/// Moves points of the cube [-1, 1]^3 towards the unit ball. A complete move would flatten the
/// tetrahedra along the cube's edges.
Eigen::Vector3d rounded(const Eigen::Vector3d& x) {
  constexpr double roundness = 0.7;
  const Eigen::Vector3d q = x.cwiseProduct(x);
  const Eigen::Vector3d ball(x[0] * std::sqrt(1 - q[1] / 2 - q[2] / 2 + q[1] * q[2] / 3),
                             x[1] * std::sqrt(1 - q[2] / 2 - q[0] / 2 + q[2] * q[0] / 3),
                             x[2] * std::sqrt(1 - q[0] / 2 - q[1] / 2 + q[0] * q[1] / 3));
  return (1 - roundness) * x + roundness * ball;
}

std::ofstream create(const std::filesystem::path& file) {
  std::ofstream out(file);
  if (!out) throw failure("cannot write {}", file.string());
  out.precision(17);
  return out;
}

void writePhysicalNames(const Mesh& mesh, std::ofstream& out) {
  out << "$PhysicalNames\n" << mesh.node_groups.size() + 1 << "\n3 1 \"body\"\n";
  int number = 1;
  for (const auto& [name, nodes] : mesh.node_groups)
    out << "0 " << number++ << " \"" << name << "\"\n";
  out << "$EndPhysicalNames\n";
}

std::size_t groupedNodes(const Mesh& mesh) {
  std::size_t count = 0;
  for (const auto& [name, nodes] : mesh.node_groups) count += nodes.size();
  return count;
}

void finishFile(std::ofstream& out, const std::filesystem::path& file) {
  out.close();
  if (!out) throw failure("cannot write {}", file.string());
}

}  // namespace

Mesh together(Mesh first, const Mesh& second) {
  const auto n = static_cast<std::int32_t>(first.nodes.size());
  first.nodes.insert(first.nodes.end(), second.nodes.begin(), second.nodes.end());
  for (const auto& [a, b, c, d] : second.tetrahedra)
    first.tetrahedra.push_back({a + n, b + n, c + n, d + n});
  finishMesh(first, "two bodies");
  return first;
}

Mesh moved(Mesh mesh, const Eigen::Vector3d& by) {
  for (Eigen::Vector3d& node : mesh.nodes) node += by;
  return mesh;
}

Mesh welded(Mesh mesh) {
  for (const auto& [node, lowest] : measure(mesh).coincident)
    for (Tetrahedron& t : mesh.tetrahedra) std::ranges::replace(t, node, lowest);
  finishMesh(mesh, "a welded body");
  return mesh;
}

Mesh beamMesh() { return boxMesh({0.1, 0.02, 0.02}, {10, 2, 2}); }

Mesh blobMesh(int n) {
  Mesh mesh = cubeMesh(n, n);
  for (Eigen::Vector3d& node : mesh.nodes) {
    const Eigen::Vector3d x = rounded(2.0 / n * node - Eigen::Vector3d::Ones());
    node = {0.1 * x[0], 0.07 * x[1] * (1 - 0.2 * x[0]), 0.05 * x[2] + 0.02 * x[0] * x[0]};
  }
  finishMesh(mesh, "a blob made in code");
  return mesh;
}

Mesh tetrahedronMesh(double edge) {
  Mesh mesh;
  mesh.nodes = {Eigen::Vector3d::Zero(), edge * Eigen::Vector3d::UnitX(),
                edge * Eigen::Vector3d::UnitY(), edge * Eigen::Vector3d::UnitZ()};
  mesh.tetrahedra = {{0, 1, 2, 3}};
  mesh.node_groups = {{"xmin", {0, 2, 3}}, {"xmax", {1}},       {"ymin", {0, 1, 3}},
                      {"ymax", {2}},       {"zmin", {0, 1, 2}}, {"zmax", {3}}};
  finishMesh(mesh, "a tetrahedron made in code");
  return mesh;
}

void writeGmsh22(const Mesh& mesh, const std::filesystem::path& file) {
  std::ofstream out = create(file);
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  writePhysicalNames(mesh, out);
  out << "$Nodes\n" << mesh.nodes.size() << "\n";
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    out << n + 1 << " " << mesh.nodes[n].transpose() << "\n";
  out << "$EndNodes\n$Elements\n" << groupedNodes(mesh) + mesh.tetrahedra.size() << "\n";
  int element = 1, group = 1;
  for (const auto& [name, nodes] : mesh.node_groups) {
    for (const std::int32_t node : nodes)
      out << element++ << " 15 2 " << group << " " << group << " " << node + 1 << "\n";
    ++group;
  }
  for (const Tetrahedron& t : mesh.tetrahedra)
    out << element++ << " 4 2 1 1 " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << " "
        << t[3] + 1 << "\n";
  out << "$EndElements\n";
  finishFile(out, file);
}

void writeGmsh41(const Mesh& mesh, const std::filesystem::path& file) {
  std::ofstream out = create(file);
  const std::size_t n_groups = mesh.node_groups.size();
  out << "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
  writePhysicalNames(mesh, out);
  out << "$Entities\n" << n_groups << " 0 0 1\n";
  for (std::size_t group = 1; group <= n_groups; ++group)
    out << group << " 0 0 0 1 " << group << "\n";
  out << "1 -1 -1 -1 1 1 1 1 1 0\n$EndEntities\n";
  out << "$Nodes\n1 " << mesh.nodes.size() << " 1 " << mesh.nodes.size() << "\n3 1 0 "
      << mesh.nodes.size() << "\n";
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) out << n + 1 << "\n";
  for (const Eigen::Vector3d& node : mesh.nodes) out << node.transpose() << "\n";
  const std::size_t n_elements = groupedNodes(mesh) + mesh.tetrahedra.size();
  out << "$EndNodes\n$Elements\n"
      << n_groups + 1 << " " << n_elements << " 1 " << n_elements << "\n";
  int element = 1, group = 1;
  for (const auto& [name, nodes] : mesh.node_groups) {
    out << "0 " << group++ << " 15 " << nodes.size() << "\n";
    for (const std::int32_t node : nodes) out << element++ << " " << node + 1 << "\n";
  }
  out << "3 1 4 " << mesh.tetrahedra.size() << "\n";
  for (const Tetrahedron& t : mesh.tetrahedra)
    out << element++ << " " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << " " << t[3] + 1
        << "\n";
  out << "$EndElements\n";
  finishFile(out, file);
}

}  // namespace palpate::test
