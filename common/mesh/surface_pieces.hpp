#pragma once

#include <algorithm>
#include <cmath>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// Return the bounding box of a surface triangle and the bounding box of a ball, metres.
inline Eigen::AlignedBox3d boxOf(const Mesh& mesh, std::int32_t triangle) {
  Eigen::AlignedBox3d box;
  for (const std::int32_t node : mesh.surface[triangle]) box.extend(mesh.nodes[node]);
  return box;
}
inline Eigen::AlignedBox3d boxAround(const Eigen::Vector3d& center, double radius) {
  return {center.array() - radius, center.array() + radius};
}

/// A small part of a surface triangle.
struct SurfacePiece {
  Eigen::Vector3d middle;       ///< m
  Eigen::Vector3d barycentric;  ///< barycentric coordinates of the middle in the triangle
  double area = 0;              ///< m^2
};

/// Divides a surface triangle into equal pieces with edges of at most `width` metres, and calls
/// visit(piece) for each.
template <class Visit>
void forEachPiece(const Mesh& mesh, std::int32_t triangle, double width, Visit visit) {
  const auto& [a, b, c] = mesh.surface[triangle];
  const Eigen::Vector3d corner = mesh.nodes[a], u = mesh.nodes[b] - corner,
                        v = mesh.nodes[c] - corner;
  const double longest = std::max({u.norm(), v.norm(), (v - u).norm()});
  const int n = std::max(1, static_cast<int>(std::ceil(longest / width)));
  const double area = u.cross(v).norm() / 2 / n / n;
  const auto visitAt = [&](double x, double y) {
    visit(SurfacePiece{corner + (x * u + y * v) / n, {1 - (x + y) / n, x / n, y / n}, area});
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j) {
      visitAt(i + 1. / 3, j + 1. / 3);
      if (i + j + 1 < n) visitAt(i + 2. / 3, j + 2. / 3);
    }
}

}  // namespace palpate
