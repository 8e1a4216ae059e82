#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// (1 - (r/radius)^2)^2, r the distance of x from `center`; zero for r > radius. Metres. Real time.
inline double bumpAt(const Eigen::Vector3d& x, const Eigen::Vector3d& center,
                     double radius) noexcept {
  const double inside = std::max(0.0, 1 - (x - center).squaredNorm() / (radius * radius));
  return inside * inside;
}

/// An integral over the surface, and how it changes when the bump moves.
struct BumpIntegral {
  double value = 0;                                     ///< m^2
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();   ///< d/d centre, m
  Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();  ///< d2/d centre2, 1; symmetric
};

/// The integral over the surface, at rest, of each node's shape function times the bump
/// (1 - (r/radius)^2)^2, r the distance from `center`, zero for r > radius: one per node, zero for
/// nodes that the bump does not reach. Shape functions are linear, or quadratic on a quadratic
/// mesh: then single values may be negative. The sum of the values is the integral of the bump; its
/// relative error is below 1e-6 however coarse the mesh, because triangles are subdivided. The
/// gradients are exactly those of the values, which are continuously differentiable; the
/// curvatures, which jump where the rim of the bump passes a quadrature point, are to 1e-2.
std::vector<BumpIntegral> bumpIntegrals(const Mesh& mesh, const Eigen::Vector3d& center,
                                        double radius);

}  // namespace palpate
