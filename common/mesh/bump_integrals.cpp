#include "common/mesh/bump_integrals.hpp"

#include <cmath>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

/// Corners, or a point, in barycentric coordinates of a surface triangle.
using Barycentric = Eigen::Vector3d;

struct QuadraturePoint {
  Barycentric at;
  double weight;  ///< of the area
};

/// Exact for polynomials of degree 5 (Radon 1948; Dunavant 1985).
std::array<QuadraturePoint, 7> degreeFive() {
  const double root = std::sqrt(15.0);
  std::array<QuadraturePoint, 7> points;
  points[0] = {Barycentric::Constant(1.0 / 3), 0.225};
  std::size_t next = 1;
  for (const double s : {root, -root}) {
    const double near = (6 + s) / 21, weight = (155 + s) / 1200;
    for (int i = 0; i < 3; ++i) {
      Barycentric at = Barycentric::Constant(near);
      at[i] = 1 - 2 * near;
      points[next++] = {at, weight};
    }
  }
  return points;
}

/// Adds up the integrals over the triangles of one surface.
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
      add(Barycentric::UnitX(), Barycentric::UnitY(), Barycentric::UnitZ());
    }
    return std::move(integrals_);
  }

 private:
  /// The bump is smooth inside the radius and only once differentiable across it: small parts see
  /// it well.
  static constexpr double part_of_radius = 1.0 / 16;

  void add(const Barycentric& a, const Barycentric& b, const Barycentric& c) {
    const Eigen::Vector3d x = corners_ * a, y = corners_ * b, z = corners_ * c;
    const double longest =
        std::sqrt(std::max({(y - x).squaredNorm(), (z - y).squaredNorm(), (x - z).squaredNorm()}));
    // Nothing of the bump reaches into a part that is farther away than it is wide.
    if (((x + y + z) / 3 - center_).norm() > radius_ + longest) return;
    if (longest > part_of_radius * radius_) {
      const Barycentric ab = (a + b) / 2, bc = (b + c) / 2, ca = (c + a) / 2;
      add(a, ab, ca);
      add(ab, b, bc);
      add(ca, bc, c);
      add(ab, bc, ca);
      return;
    }
    static const std::array<QuadraturePoint, 7> points = degreeFive();
    const double area = (y - x).cross(z - x).norm() / 2;
    for (const QuadraturePoint& point : points)
      addPoint(point.at[0] * a + point.at[1] * b + point.at[2] * c, point.weight * area);
  }

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
  Eigen::Matrix3d corners_;                 ///< of the surface triangle, one per column
  std::array<std::int32_t, 6> nodes_ = {};  ///< its vertices, then the middles of 01, 12, 20
  std::vector<BumpIntegral> integrals_;
};

}  // namespace

std::vector<BumpIntegral> bumpIntegrals(const Mesh& mesh, const Eigen::Vector3d& center,
                                        double radius) {
  PALPATE_ASSERT(radius > 0, "a scene gives weighted tools a radius");
  return Integration(mesh, center, radius).run();
}

}  // namespace palpate
