#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace palpate {

/// The ten quantities of an energy at a place s: E, T = -dE/ds (3) and dT/ds = -d2E/ds2 (xx, xy,
/// xz, yy, yz, zz).
inline constexpr int place_quantities = 10;

/// The axes of the six components of a symmetric matrix, in their order among the quantities.
inline constexpr std::array<std::array<int, 2>, 6> symmetric_axes = {
    {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}};

/// Interpolates quantities in space: those at `place` are coefficients * those at `sites`, one
/// after the other; place_quantities rows, so many columns per site. It is the interpolant of least
/// norm through values, gradients and curvatures at all sites (Hermite-Birkhoff interpolation; Wu
/// 1992) with the inverse multiquadric 1 / sqrt(1 + r^2 / width^2), which is positive definite.
/// Exact at the sites. `width`, metres, about that over which the energy changes; sites at distinct
/// places.
Eigen::MatrixXf hermiteCoefficients(const Eigen::Vector3d& place,
                                    const std::vector<Eigen::Vector3d>& sites, double width);

}  // namespace palpate
