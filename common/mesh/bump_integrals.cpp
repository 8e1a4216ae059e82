#include "common/mesh/bump_integrals.hpp"

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

using Barycentric = Eigen::Vector3d;

/// Adds up the integrals of all nodes over the triangles of a surface.
class Integration {
 public:
  Integration(const Mesh& mesh, const Eigen::Vector3d& center, double radius)
      : mesh_(mesh), center_(center), radius_(radius), integrals_(mesh.nodes.size()) {}

  std::vector<BumpIntegral> run() {
    for (const Triangle& triangle : mesh_.surface) {
      for (int i = 0; i < 3; ++i) {
        corners_.col(i) = mesh_.nodes[triangle[i]];
        nodes_[i] = triangle[i];
        if (!mesh_.edges.empty())
          nodes_[3 + i] = midEdgeNode(mesh_, triangle[i], triangle[(i + 1) % 3]);
      }
      BumpQuadrature(center_, radius_).over(corners_, [this](const Barycentric& l, double area) {
        addPoint(l, area);
      });
    }
    return std::move(integrals_);
  }

 private:
  void addPoint(const Barycentric& l, double area) {
    const Eigen::Vector3d away = corners_ * l - center_;
    const double relative = away.squaredNorm() / (radius_ * radius_);
    if (relative >= 1) return;
    const double bump = (1 - relative) * (1 - relative) * area;
    const double slope = 4 * (1 - relative) / (radius_ * radius_) * area;
    const Eigen::Vector3d gradient = slope * away;
    Eigen::Matrix3d curvature =
        8 / (radius_ * radius_ * radius_ * radius_) * area * away * away.transpose();
    curvature.diagonal().array() -= slope;
    const auto addTo = [&](std::int32_t node, double shape) {
      BumpIntegral& integral = integrals_[node];
      integral.value += bump * shape;
      integral.gradient += shape * gradient;
      integral.curvature += shape * curvature;
    };
    for (int i = 0; i < 3; ++i) {
      addTo(nodes_[i], mesh_.edges.empty() ? l[i] : l[i] * (2 * l[i] - 1));
      if (!mesh_.edges.empty()) addTo(nodes_[3 + i], 4 * l[i] * l[(i + 1) % 3]);
    }
  }

  const Mesh& mesh_;
  const Eigen::Vector3d& center_;
  double radius_;
  Eigen::Matrix3d corners_;                 ///< corners of the current triangle, one per column
  std::array<std::int32_t, 6> nodes_ = {};  ///< its vertices, then the mid-edge nodes of 01, 12, 20
  std::vector<BumpIntegral> integrals_;
};

}  // namespace

std::vector<BumpIntegral> bumpIntegrals(const Mesh& mesh, const Eigen::Vector3d& center,
                                        double radius) {
  PALPATE_ASSERT(radius > 0, "a weighted tool must have a radius");
  return Integration(mesh, center, radius).run();
}

}  // namespace palpate
