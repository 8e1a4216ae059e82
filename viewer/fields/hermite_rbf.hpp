#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "viewer/fields/rbf_kernels.hpp"

namespace palpate {

/// A scalar with its derivatives at one place.
struct Jet {
  double value = 0;
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
};

/// Hermite-Birkhoff interpolation by radial functions: the function of least energy (of r^7: a
/// spline) whose value, gradient and Hessian are those given at every point,
///
///   f(p) = sum over points, over the ten functionals l of a point, of  w_l l(phi(|p - .|))  +
///   cubic polynomial
///
/// phi = r^7. Symmetric conditionally positive definite system of 10 unknowns per point
/// (common/interpolation/conditional_system.hpp): (10 n)^3 / 3 multiplications. Cubics are
/// reproduced where the points determine them; one point gives its Taylor polynomial.
class HermiteRbf {
 public:
  static constexpr Eigen::Index functionals = 10;  ///< of a point: value, x y z, xx yy zz yz xz xy

  HermiteRbf() = default;
  /// positions and jets in units in which neighbours are about 1 apart, near the origin. Error when
  /// the points are too close to each other to be told apart.
  HermiteRbf(const std::vector<Eigen::Vector3d>& positions, const std::vector<Jet>& jets);

  /// Real time.
  Jet evaluate(const RbfKernels& kernels, const Eigen::Vector3d& p) const noexcept;
  double residual() const {
    return residual_;
  }  ///< largest error at a datum, relative to the largest datum

 private:
  std::vector<HermiteBlock> blocks_;
  std::array<double, 20> polynomial_ = {};  ///< of the monomials in hermite_rbf.cpp
  double residual_ = 0;
};

}  // namespace palpate
