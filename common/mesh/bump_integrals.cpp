#include "common/mesh/bump_integrals.hpp"

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

/// Returns the bump and, if asked, its derivatives, times `area`, at the offset `away` from the
/// centre.
BumpIntegral bumpTimes(double area, const Eigen::Vector3d& away, double radius, bool derivatives) {
  const double relative = away.squaredNorm() / (radius * radius);
  if (relative >= 1) return {};
  if (!derivatives) return {.value = (1 - relative) * (1 - relative) * area};
  const double slope = 4 * (1 - relative) / (radius * radius) * area;
  BumpIntegral bump = {(1 - relative) * (1 - relative) * area, slope * away,
                       8 / (radius * radius * radius * radius) * area * away * away.transpose()};
  bump.curvature.diagonal().array() -= slope;
  return bump;
}

}  // namespace

std::vector<BumpIntegral> bumpIntegrals(const Mesh& mesh, const Eigen::Vector3d& center,
                                        double radius, bool derivatives) {
  PALPATE_ASSERT(radius > 0, "a weighted tool must have a radius");
  const bool quadratic = !mesh.edges.empty();
  std::vector<BumpIntegral> integrals(mesh.nodes.size());
  for (const Triangle& triangle : mesh.surface) {
    Eigen::Matrix3d corners;               // one per column
    std::array<std::int32_t, 3> middle{};  // mid-edge nodes of 01, 12, 20
    for (int i = 0; i < 3; ++i) {
      corners.col(i) = mesh.nodes[triangle[i]];
      if (quadratic) middle[i] = midEdgeNode(mesh, triangle[i], triangle[(i + 1) % 3]);
    }
    BumpQuadrature(center, radius).over(corners, [&](const Eigen::Vector3d& l, double area) {
      const BumpIntegral bump = bumpTimes(area, corners * l - center, radius, derivatives);
      const auto addTo = [&](BumpIntegral& integral, double shape) {
        integral.value += bump.value * shape;
        if (!derivatives) return;
        integral.gradient += shape * bump.gradient;
        integral.curvature += shape * bump.curvature;
      };
      for (int i = 0; i < 3; ++i) {
        addTo(integrals[triangle[i]], quadratic ? l[i] * (2 * l[i] - 1) : l[i]);
        if (quadratic) addTo(integrals[middle[i]], 4 * l[i] * l[(i + 1) % 3]);
      }
    });
  }
  return integrals;
}

}  // namespace palpate
