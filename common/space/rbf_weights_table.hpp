#pragma once

#include <Eigen/Core>

namespace palpate {

/// Radial function of an interpolation.
enum class RbfKernel { linear, cubic };  ///< r, r^3

/// Global interpolation of the force of a configuration space over its solved points (paper, Eq.
/// 12):
///
///   force(p) = sum over solved points i of  w_i phi(|p - p_i| / spacing)  +  tail
///
/// The tail is a constant for r, c0 + (c1 x + c2 y + c3 z) / spacing for r^3, or absent as in the
/// paper.
struct RbfWeights {
  RbfKernel kernel = RbfKernel::linear;
  bool has_tail = false;
  /// N; a row per solved point, in the order of their lattice numbers.
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> weights;
  /// N; 1 x 3 (linear) or 4 x 3 (cubic: constant, x, y, z) with a tail, else 0 x 3.
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> tail;
  double condition = 0;  ///< estimate for the definite part of the matrix, 1-norm
  double residual = 0;   ///< largest error of a force component at a solved point, relative to the
                         ///< largest; infinite when the system has no solution
  /// The residual is what rounding leaves. Otherwise the weights are worth nothing.
  bool accurate() const { return residual <= 1e-8; }
};

}  // namespace palpate
