#include "tests/verification/meshes.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <utility>

#include "common/base/assertion.hpp"

namespace palpate::verification {
namespace {

/// The six orders in which a path along edges from one corner of a brick to the opposite corner can
/// take the axes. The last three are odd permutations.
constexpr std::array<std::array<int, 3>, 6> axis_orders = {
    {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};

/// Returns the tetrahedron of the four nodes on the path from `corner` that takes the axes in this
/// order.
Tetrahedron kuhnTetrahedron(std::int32_t corner, const std::array<int, 3>& strides, int order) {
  Tetrahedron nodes = {corner};
  for (int i = 0; i < 3; ++i) nodes[i + 1] = nodes[i] + strides[axis_orders[order][i]];
  // A path of odd order gives a tetrahedron of opposite orientation.
  if (order >= 3) std::swap(nodes[2], nodes[3]);
  return nodes;
}

/// Returns a box for finishMesh, with nodes on the unit lattice: node (i, j, k) is at (i, j, k).
Mesh latticeBox(const std::array<int, 3>& cells) {
  const std::array<int, 3> strides = {1, cells[0] + 1, (cells[0] + 1) * (cells[1] + 1)};
  Mesh mesh;
  for (int k = 0; k <= cells[2]; ++k)
    for (int j = 0; j <= cells[1]; ++j)
      for (int i = 0; i <= cells[0]; ++i) {
        const auto node = static_cast<std::int32_t>(mesh.nodes.size());
        const std::array<int, 3> place = {i, j, k};
        mesh.nodes.emplace_back(i, j, k);
        for (int axis = 0; axis < 3; ++axis) {
          const std::string letter = {"xyz"[axis]};
          if (place[axis] == 0) mesh.node_groups[letter + "min"].push_back(node);
          if (place[axis] == cells[axis]) mesh.node_groups[letter + "max"].push_back(node);
        }
        if (i == cells[0] || j == cells[1] || k == cells[2]) continue;
        for (int order = 0; order < 6; ++order)
          mesh.tetrahedra.push_back(kuhnTetrahedron(node, strides, order));
      }
  return mesh;
}

/// Cuts the prism over the triangle (a, b, c), with ascending a, b, c, into three tetrahedra.
/// Neighbouring prisms divide their common side face by the same diagonal. This diagonal joins the
/// lower of two node numbers on the lower triangle with the higher one on the upper triangle.
void cutPrism(const Triangle& below, std::int32_t above, std::vector<Tetrahedron>& tetrahedra) {
  const auto [a, b, c] = below;
  PALPATE_ASSERT(a < b && b < c, "nodes must ascend, so that neighbours choose the same diagonal");
  tetrahedra.push_back({a, b, c, c + above});
  tetrahedra.push_back({a, b, b + above, c + above});
  tetrahedra.push_back({a, a + above, b + above, c + above});
}

/// Triangles over numbered points of a plane.
struct Grid {
  std::vector<Eigen::Vector2d> points;
  std::vector<Triangle> triangles;  ///< counter-clockwise
};

/// Returns [0, 1]^2 divided into n x m cells of two triangles each. The edge between the two
/// triangles runs from lower left to upper right.
Grid squareGrid(int n, int m) {
  Grid grid;
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i <= n; ++i) grid.points.emplace_back(double(i) / n, double(j) / m);
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      const std::int32_t a = i + (n + 1) * j, b = a + 1, c = b + n + 1, d = a + n + 1;
      grid.triangles.push_back({a, b, c});
      grid.triangles.push_back({a, c, d});
    }
  return grid;
}

/// Returns the triangle (0,0) (1,0) (0,1) divided into n^2 equal ones.
Grid triangleGrid(int n) {
  Grid grid;
  const auto number = [n](int i, int j) { return i + j * (n + 1) - j * (j - 1) / 2; };
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n - j; ++i) grid.points.emplace_back(double(i) / n, double(j) / n);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n - j; ++i) {
      const std::int32_t a = number(i, j), b = number(i, j + 1);
      grid.triangles.push_back({a, a + 1, b});
      if (i < n - j - 1) grid.triangles.push_back({a + 1, b + 1, b});
    }
  return grid;
}

/// Returns the unit disc in n rings around point 0; ring k has 6 k points.
Grid discGrid(int n) {
  const auto number = [](int ring, int place) {
    return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1) + place % (6 * ring);
  };
  Grid grid;
  grid.points.emplace_back(0, 0);
  for (int ring = 1; ring <= n; ++ring) {
    for (int place = 0; place < 6 * ring; ++place) {
      const double angle = std::numbers::pi / 3 * place / ring;
      grid.points.emplace_back(double(ring) / n *
                               Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
    for (int sector = 0; sector < 6; ++sector)
      for (int i = 0; i < ring; ++i) {
        const int outer = sector * ring + i, inner = sector * (ring - 1) + i;
        const std::int32_t a = number(ring, outer), b = number(ring, outer + 1),
                           c = number(ring - 1, inner), d = number(ring - 1, inner + 1);
        grid.triangles.push_back({a, b, c});
        if (i < ring - 1) grid.triangles.push_back({c, b, d});
      }
  }
  return grid;
}

/// Returns `layers` layers of prisms over the triangles of `grid`, each prism cut into three
/// tetrahedra. `position` maps (x, y, z) to metres, with x and y in the grid and z in [0, 1] across
/// the layers.
Mesh layeredMesh(const Grid& grid, int layers,
                 const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& position) {
  Mesh mesh;
  const auto points = static_cast<std::int32_t>(grid.points.size());
  for (int layer = 0; layer <= layers; ++layer)
    for (std::int32_t point = 0; point < points; ++point) {
      const auto node = static_cast<std::int32_t>(mesh.nodes.size());
      const Eigen::Vector2d& x = grid.points[point];
      mesh.nodes.push_back(position({x[0], x[1], double(layer) / layers}));
      if (layer == 0) mesh.node_groups["first"].push_back(node);
      if (layer == layers) mesh.node_groups["last"].push_back(node);
    }
  for (int layer = 0; layer < layers; ++layer)
    for (Triangle triangle : grid.triangles) {
      std::sort(triangle.begin(), triangle.end());
      for (std::int32_t& node : triangle) node += layer * points;
      cutPrism(triangle, points, mesh.tetrahedra);
    }
  // Sorting reversed some of the triangles, and `position` may mirror all of them.
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e)
    if (sixVolume(mesh, e) < 0) std::swap(mesh.tetrahedra[e][2], mesh.tetrahedra[e][3]);
  finishMesh(mesh, "a verification mesh made in code");
  return mesh;
}

}  // namespace

Mesh boxMesh(const Eigen::Vector3d& size, const std::array<int, 3>& cells) {
  return distortedBoxMesh(size, cells, 0.0);
}

Mesh cubeMesh(double edge, int n) { return boxMesh(Eigen::Vector3d::Constant(edge), {n, n, n}); }

Mesh distortedBoxMesh(const Eigen::Vector3d& size, const std::array<int, 3>& cells, double amount) {
  const Eigen::Vector3d corner = Eigen::Vector3i::Map(cells.data()).cast<double>();
  Mesh mesh = latticeBox(cells);
  std::mt19937 random(1);
  for (Eigen::Vector3d& node : mesh.nodes)
    for (int axis = 0; axis < 3; ++axis) {
      // uniform_real_distribution gives different values in different standard libraries.
      const double move = amount * (2.0 * random() / 4294967295.0 - 1);
      const bool inner = (node.array() > 0.5 && node.array() < corner.array() - 0.5).all();
      if (inner) node[axis] += move;
    }
  for (Eigen::Vector3d& node : mesh.nodes) node = node.cwiseQuotient(corner).cwiseProduct(size);
  finishMesh(mesh, "a box made in code");
  return mesh;
}

Mesh cookMesh(int n, double thickness) {
  return layeredMesh(squareGrid(n, n), 1, [thickness](const Eigen::Vector3d& x) {
    const double bottom = 0.044 * x[0], top = 0.044 + 0.016 * x[0];
    return Eigen::Vector3d(0.048 * x[0], bottom + (top - bottom) * (1 - x[1]), thickness * x[2]);
  });
}

Mesh cylinderMesh(double radius, double length, int n, int layers) {
  return layeredMesh(discGrid(n), layers, [=](const Eigen::Vector3d& x) {
    return Eigen::Vector3d(radius * x[0], radius * x[1], length * x[2]);
  });
}

Mesh quarterTubeMesh(double inner, double outer, double thickness, int n) {
  Mesh mesh = layeredMesh(squareGrid(n, n), 1, [=](const Eigen::Vector3d& x) {
    const double angle = std::numbers::pi / 2 * x[0], radius = inner + (outer - inner) * x[1];
    return Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), thickness * x[2]);
  });
  for (std::size_t node = 0; node < mesh.nodes.size(); ++node)
    if (mesh.nodes[node].head<2>().norm() < inner + (outer - inner) / (2 * n))
      mesh.node_groups["inner"].push_back(static_cast<std::int32_t>(node));
  return mesh;
}

Mesh ballOctantMesh(double radius, int n) {
  Mesh mesh = latticeBox({n, n, n});
  std::vector<std::int32_t>& outside = mesh.node_groups["outside"];
  for (std::size_t node = 0; node < mesh.nodes.size(); ++node) {
    Eigen::Vector3d& X = mesh.nodes[node];
    const double shell = X.maxCoeff();
    if (shell > n - 0.5) outside.push_back(static_cast<std::int32_t>(node));
    if (shell > 0) X *= radius / n * shell / X.norm();
  }
  finishMesh(mesh, "a verification mesh made in code");
  return mesh;
}

Mesh sphereOctantMesh(double inner, double outer, int n) {
  return layeredMesh(triangleGrid(n), n, [=](const Eigen::Vector3d& x) {
    const Eigen::Vector3d direction(1 - x[0] - x[1], x[0], x[1]);
    return Eigen::Vector3d((inner + (outer - inner) * x[2]) * direction.normalized());
  });
}

}  // namespace palpate::verification
