#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// Returns (1 - (r/radius)^2)^2, with r the distance of x from `center` in metres; zero for r >
/// radius. Real time.
inline double bumpAt(const Eigen::Vector3d& x, const Eigen::Vector3d& center,
                     double radius) noexcept {
  const double squared = (x - center).squaredNorm();
  if (!(squared < radius * radius)) return 0;  // in most calls; saves the division
  const double inside = 1 - squared / (radius * radius);
  return inside * inside;
}

/// Quadrature over triangles for integrands that contain a bump (bumpAt). Triangles are subdivided
/// so finely that the rim of the bump, where it is only once differentiable, does not matter.
class BumpQuadrature {
 public:
  /// `radius` is in metres. `part` is the largest edge of the triangles after subdivision, in
  /// radii.
  BumpQuadrature(const Eigen::Vector3d& center, double radius, double part = 1.0 / 16) noexcept
      : center_(center), radius_(radius), part_(part * radius) {}

  /// Calls visit(barycentric coordinates, weight) for each quadrature point of a triangle, given by
  /// its corners as columns. The weight is the part of the triangle's area, m^2, that the point
  /// stands for. Skips points in parts of the triangle that the bump does not reach. Real time.
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
    // The bump does not reach this part: its centroid is farther outside the radius than the part
    // is wide.
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
    constexpr double third = 1.0 / 3, root = 3.872983346207417;  // root of 15
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

/// An integral over the surface and its derivatives with respect to the centre of the bump.
struct BumpIntegral {
  double value = 0;                                     ///< m^2
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();   ///< d/d centre, m
  Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();  ///< d2/d centre2, dimensionless, symmetric
};

/// Returns, for each node, the integral over the rest surface of its shape function times the bump
/// of bumpAt(). The integral is zero for nodes that the bump does not reach. Shape functions are
/// linear, or quadratic on a quadratic mesh, where single values may be negative. The values add up
/// to the integral of the bump. The relative error of this sum is below 1e-6 for any mesh, because
/// triangles are subdivided. The values are continuously differentiable, and the gradients are
/// exact. The curvatures jump where the rim of the bump passes a quadrature point and are accurate
/// to 1e-2. Without `derivatives`, gradients and curvatures are zero, which saves most of the time.
std::vector<BumpIntegral> bumpIntegrals(const Mesh& mesh, const Eigen::Vector3d& center,
                                        double radius, bool derivatives = true);

}  // namespace palpate
