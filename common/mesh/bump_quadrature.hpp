#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

namespace palpate {

/// Integrates a bump of a radius (metres) over triangles, in parts so small that its rim, where it
/// is only once differentiable, does not matter.
class BumpQuadrature {
 public:
  /// part: of the radius, the widest part of a triangle.
  BumpQuadrature(const Eigen::Vector3d& center, double radius, double part = 1.0 / 16) noexcept
      : center_(center), radius_(radius), part_(part * radius) {}

  /// Calls visit(barycentric coordinates, area that the point stands for, m^2) at points of a
  /// triangle, whose corners are columns. What is beyond the radius is left out in part. Real time.
  template <class Visit>
  void over(const Eigen::Matrix3d& corners, const Visit& visit) const noexcept {
    const Eigen::Matrix3d unit = Eigen::Matrix3d::Identity();
    add(corners, unit.col(0), unit.col(1), unit.col(2), visit);
  }

 private:
  using Barycentric = Eigen::Vector3d;

  template <class Visit>
  void add(const Eigen::Matrix3d& corners, const Barycentric& a, const Barycentric& b,
           const Barycentric& c, const Visit& visit) const noexcept {
    const Eigen::Vector3d x = corners * a, y = corners * b, z = corners * c;
    const double longest =
        std::sqrt(std::max({(y - x).squaredNorm(), (z - y).squaredNorm(), (x - z).squaredNorm()}));
    // Nothing of the bump reaches into a part that is farther away than it is wide.
    if (((x + y + z) / 3 - center_).norm() > radius_ + longest) return;
    if (longest > part_) {
      const Barycentric ab = (a + b) / 2, bc = (b + c) / 2, ca = (c + a) / 2;
      add(corners, a, ab, ca, visit);
      add(corners, ab, b, bc, visit);
      add(corners, ca, bc, c, visit);
      add(corners, ab, bc, ca, visit);
      return;
    }
    // Exact for polynomials of degree 5 (Radon 1948; Dunavant 1985).
    constexpr double third = 1.0 / 3, root = 3.872983346207417;  // of 15
    const double area = (y - x).cross(z - x).norm() / 2;
    visit(Barycentric(third * a + third * b + third * c), 0.225 * area);
    for (const double s : {root, -root}) {
      const double near = (6 + s) / 21, far = 1 - 2 * near, weight = (155 + s) / 1200;
      visit(Barycentric(far * a + near * b + near * c), weight * area);
      visit(Barycentric(near * a + far * b + near * c), weight * area);
      visit(Barycentric(near * a + near * b + far * c), weight * area);
    }
  }

  const Eigen::Vector3d center_;
  const double radius_, part_;
};

}  // namespace palpate
