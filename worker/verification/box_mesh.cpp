#include "worker/verification/box_mesh.hpp"

#include <random>
#include <string>
#include <utility>

namespace palpate {
namespace {

/// The six orders in which a path from one corner of a brick to the opposite one can take the three
/// axes.
constexpr std::array<std::array<int, 3>, 6> axis_orders = {
    {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};

using Cells = std::array<int, 3>;

std::int32_t numberOf(const Cells& cells, const std::array<int, 3>& at) {
  return at[0] + (cells[0] + 1) * (at[1] + (cells[1] + 1) * at[2]);
}

Tetrahedron kuhnTetrahedron(const Cells& cells, std::array<int, 3> at, int order) {
  Tetrahedron nodes;
  nodes[0] = numberOf(cells, at);
  for (int i = 0; i < 3; ++i) {
    ++at[axis_orders[order][i]];
    nodes[i + 1] = numberOf(cells, at);
  }
  const bool even_order = order < 3;
  if (!even_order) std::swap(nodes[2], nodes[3]);
  return nodes;
}

/// The box before finishMesh, with its nodes on the unit lattice: node (i, j, k) is at (i, j, k).
Mesh latticeBox(const Cells& cells) {
  Mesh mesh;
  for (int k = 0; k <= cells[2]; ++k)
    for (int j = 0; j <= cells[1]; ++j)
      for (int i = 0; i <= cells[0]; ++i) {
        const auto node = static_cast<std::int32_t>(mesh.nodes.size());
        mesh.nodes.emplace_back(i, j, k);
        const std::array<int, 3> at = {i, j, k};
        for (int axis = 0; axis < 3; ++axis) {
          const std::string letter(1, static_cast<char>('x' + axis));
          if (at[axis] == 0) mesh.node_groups[letter + "min"].push_back(node);
          if (at[axis] == cells[axis]) mesh.node_groups[letter + "max"].push_back(node);
        }
      }
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j)
      for (int i = 0; i < cells[0]; ++i)
        for (int order = 0; order < 6; ++order)
          mesh.tetrahedra.push_back(kuhnTetrahedron(cells, {i, j, k}, order));
  return mesh;
}

Eigen::Vector3d asVector(const Cells& cells) {
  return {double(cells[0]), double(cells[1]), double(cells[2])};
}

}  // namespace

Mesh boxMesh(const Eigen::Vector3d& size, const std::array<int, 3>& cells) {
  return distortedBoxMesh(size, cells, 0.0);
}

Mesh cubeMesh(double edge, int n) { return boxMesh(Eigen::Vector3d::Constant(edge), {n, n, n}); }

Mesh distortedBoxMesh(const Eigen::Vector3d& size, const std::array<int, 3>& cells, double amount,
                      std::uint32_t seed) {
  Mesh mesh = latticeBox(cells);
  std::mt19937 random(seed);
  for (Eigen::Vector3d& node : mesh.nodes)
    for (int axis = 0; axis < 3; ++axis) {
      // Not uniform_real_distribution: its values differ between standard libraries.
      const double move = amount * (2.0 * random() / 4294967295.0 - 1);
      const bool inner = (node.array() > 0.5 && node.array() < asVector(cells).array() - 0.5).all();
      if (inner) node[axis] += move;
    }
  for (Eigen::Vector3d& node : mesh.nodes)
    node = node.cwiseQuotient(asVector(cells)).cwiseProduct(size);
  finishMesh(mesh, "a box made in code");
  return mesh;
}

}  // namespace palpate
