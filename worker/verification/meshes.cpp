#include "worker/verification/meshes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace palpate::verification {
namespace {

/// The prism over triangle (a, b, c), which must ascend, cut so that neighbours agree: every
/// diagonal of a side face runs from its lower number below to its higher number above.
void cutPrism(const Triangle& below, std::int32_t above, std::vector<Tetrahedron>& tetrahedra) {
  const auto [a, b, c] = below;
  tetrahedra.push_back({a, b, c, c + above});
  tetrahedra.push_back({a, b, b + above, c + above});
  tetrahedra.push_back({a, a + above, b + above, c + above});
}

void turnNegativeTetrahedra(Mesh& mesh) {
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e)
    if (sixVolume(mesh, e) < 0) std::swap(mesh.tetrahedra[e][2], mesh.tetrahedra[e][3]);
}

}  // namespace

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

Grid triangleGrid(int n) {
  Grid grid;
  std::vector<std::int32_t> first_of_row;
  for (int j = 0; j <= n; ++j) {
    first_of_row.push_back(static_cast<std::int32_t>(grid.points.size()));
    for (int i = 0; i <= n - j; ++i) grid.points.emplace_back(double(i) / n, double(j) / n);
  }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n - j; ++i) {
      const std::int32_t a = first_of_row[j] + i, b = first_of_row[j + 1] + i;
      grid.triangles.push_back({a, a + 1, b});
      if (i < n - j - 1) grid.triangles.push_back({a + 1, b + 1, b});
    }
  return grid;
}

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
        grid.triangles.push_back(
            {number(ring, outer), number(ring, outer + 1), number(ring - 1, inner)});
        if (i < ring - 1)
          grid.triangles.push_back(
              {number(ring - 1, inner), number(ring, outer + 1), number(ring - 1, inner + 1)});
      }
  }
  return grid;
}

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
  turnNegativeTetrahedra(mesh);
  finishMesh(mesh, "a verification mesh made in code");
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

Mesh sphereOctantMesh(double inner, double outer, int n) {
  return layeredMesh(triangleGrid(n), n, [=](const Eigen::Vector3d& x) {
    const Eigen::Vector3d direction(1 - x[0] - x[1], x[0], x[1]);
    return Eigen::Vector3d((inner + (outer - inner) * x[2]) * direction.normalized());
  });
}

}  // namespace palpate::verification
