#pragma once

#include <span>

#include "common/base/index.hpp"
#include "common/mesh/bump_integrals.hpp"
#include "common/mesh/surface_point.hpp"

namespace palpate {

/// Adds a bump around a surface point to the displacements of the vertices (`out`, [vertex][axis],
/// metres), so that the point is displaced by exactly p. The point lies in `triangle` at the given
/// barycentric coordinates; `position` is its rest position, metres. `radius` is the radius of the
/// bump, metres; at least one corner of the triangle must lie within it. Real time.
inline void moveAnchor(std::span<const Eigen::Vector3d> vertices, const Triangle& triangle,
                       const Eigen::Vector3d& barycentric, const Eigen::Vector3d& position,
                       double radius, const Eigen::Vector3d& p, std::span<float> out) noexcept {
  Eigen::Vector3d missing = p;
  double bump = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t corner = at(triangle[c]);
    const double share = barycentric[static_cast<Eigen::Index>(c)];
    missing -= share * Eigen::Map<const Eigen::Vector3f>(out.data() + 3 * corner).cast<double>();
    bump += share * bumpAt(vertices[corner], position, radius);
  }
  const Eigen::Vector3f height = (missing / bump).cast<float>();
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const auto share = static_cast<float>(bumpAt(vertices[v], position, radius));
    if (share > 0) Eigen::Map<Eigen::Vector3f>(out.data() + 3 * v) += share * height;
  }
}

}  // namespace palpate
