#include "common/mesh/free_share.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/assertion.hpp"
#include "common/mesh/bump_integrals.hpp"
#include "common/mesh/surface_pieces.hpp"

namespace palpate {

FreeShare::FreeShare(const Mesh& mesh, const NodeSet& fixed, double radius) : radius_(radius) {
  PALPATE_ASSERT(radius > 0, "a weighted tool must have a radius");
  const auto free = [&](std::int32_t node) { return contains(fixed, node) ? 0.0 : 1.0; };
  for (std::int32_t t = 0; static_cast<std::size_t>(t) < mesh.surface.size(); ++t) {
    const Triangle& triangle = mesh.surface[t];
    Part& part = parts_.emplace_back();
    part.box = boxOf(mesh, t);
    part.is_quadratic = !mesh.edges.empty();
    part.free.fill(1);
    for (std::size_t i = 0; i < 3; ++i) {
      part.corners.col(static_cast<Eigen::Index>(i)) = mesh.nodes[triangle[i]];
      part.free[i] = free(triangle[i]);
      if (part.is_quadratic)
        part.free[3 + i] = free(midEdgeNode(mesh, triangle[i], triangle[(i + 1) % 3]));
    }
  }
  const auto all_free = std::partition(parts_.begin(), parts_.end(), [](const Part& part) {
    return std::ranges::find(part.free, 0.0) != part.free.end();
  });
  with_fixed_ = static_cast<std::size_t>(all_free - parts_.begin());
}

double FreeShare::freeAt(const Part& part, const Eigen::Vector3d& l) noexcept {
  double share = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double here = l[static_cast<Eigen::Index>(i)],
                 next = l[static_cast<Eigen::Index>((i + 1) % 3)];
    share += part.free[i] * (part.is_quadratic ? here * (2 * here - 1) : here);
    if (part.is_quadratic) share += part.free[3 + i] * 4 * here * next;
  }
  return share;
}

bool FreeShare::isNear(const Part& part, const Eigen::Vector3d& center) const noexcept {
  return part.box.squaredExteriorDistance(center) < radius_ * radius_;
}

double FreeShare::shareAt(const Eigen::Vector3d& center, double part_of_radius) const noexcept {
  double whole = 0, free = 0;
  const BumpQuadrature quadrature(center, radius_, part_of_radius);
  for (const Part& part : parts_)
    if (isNear(part, center))
      quadrature.over(part.corners, [&](const Eigen::Vector3d& l, double area) {
        const double bump = bumpAt(part.corners * l, center, radius_) * area;
        whole += bump;
        free += bump * freeAt(part, l);
      });
  return whole > 0 ? free / whole : 0;
}

bool FreeShare::isBelow(double share, const Eigen::Vector3d& center) const noexcept {
  const auto all_free = parts_.begin() + static_cast<std::ptrdiff_t>(with_fixed_);
  if (std::none_of(parts_.begin(), all_free,
                   [&](const Part& part) { return isNear(part, center); }))
    return false;
  constexpr double rough_part = 1.0 / 4, rough_error = 0.02, fine_part = 1.0 / 16;
  const double rough = shareAt(center, rough_part);
  if (std::abs(rough - share) > rough_error) return rough < share;
  return shareAt(center, fine_part) < share;
}

}  // namespace palpate
