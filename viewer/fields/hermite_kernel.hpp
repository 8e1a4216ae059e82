#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/space/configuration.hpp"

namespace palpate {

/// Number of quantities of an energy at a place s: E (1), T = -dE/ds (3) and dT/ds = -d2E/ds2 (6,
/// in the order of symmetric_axes).
inline constexpr int place_quantities = 10;

struct HermiteWeights {
  /// Matrix with place_quantities rows, and place_quantities columns per site.
  Eigen::MatrixXf coefficients;
  /// First row of `coefficients`, minus the row of an interpolant that does not use dT/ds. It gives
  /// the difference of the two energies, from which the error is estimated.
  Eigen::RowVectorXf order_difference;
};

/// Returns the weights that interpolate the quantities from `sites` to `place`: the quantities at
/// `place` are `coefficients` times the stacked quantities of all sites. The kernel of the
/// interpolation (Hermite-Birkhoff; Wu 1992) is the inverse multiquadric 1 / sqrt(1 + r^2 /
/// width^2), which is positive definite.
///
/// E is exact at the sites. T and dT/ds are treated as noisy data (kriging with a nugget). Sites
/// without a solution at the displacement have extrapolated values, and neighbouring sites may lie
/// on different branches. An exact interpolant of contradictory data would overshoot.
///
/// `width`: metres, about the distance over which the energy changes. The sites must be distinct.
HermiteWeights hermiteWeights(const Eigen::Vector3d& place,
                              const std::vector<Eigen::Vector3d>& sites, double width);

}  // namespace palpate
