#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/space/configuration.hpp"

namespace palpate {

/// The ten quantities of an energy at a place s: E, T = -dE/ds (3) and dT/ds = -d2E/ds2 (6, by
/// symmetric_axes).
inline constexpr int place_quantities = 10;

struct HermiteWeights {
  /// place_quantities rows, so many columns per site.
  Eigen::MatrixXf coefficients;
  /// Standard error of the energy at the place, as a share of what it would be without any site:
  /// the power function of the kernel (Wu and Schaback 1993). 0 at a site.
  double power = 0;
};

/// Interpolates quantities in space: those at `place` are coefficients * those at `sites`, one
/// after the other. It is the interpolant of least
/// norm through values, gradients and curvatures at all sites (Hermite-Birkhoff interpolation; Wu
/// 1992) with the inverse multiquadric 1 / sqrt(1 + r^2 / width^2), which is positive definite.
/// Exact at the sites that are `solved`. T and dT/ds of the others are extrapolated, and are met as
/// data with noise would be (kriging with a nugget): extrapolating loses most in derivatives, and
/// the kernel would hand on what is wrong, times their distance, to every place around. `width`,
/// metres, about that over which the energy changes; sites at distinct places.
HermiteWeights hermiteWeights(const Eigen::Vector3d& place,
                              const std::vector<Eigen::Vector3d>& sites,
                              const std::vector<bool>& solved, double width);

}  // namespace palpate
