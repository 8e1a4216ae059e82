#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "common/space/space_table.hpp"

namespace palpate {

/// Radial function of an interpolation.
enum class RbfKernel { linear, cubic };  ///< phi(r) = r, r^3

/// Global interpolation of the force of a configuration space over its solved points (paper, Eq.
/// 12):
///
///   force(p) = sum over solved points i of  w_i phi(|p - p_i| / spacing)
struct RbfWeights {
  /// N; n x 3, a row per solved point, in the order of their lattice numbers.
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> weights;
  double condition = 0;  ///< of the matrix phi(|p_i - p_j|), estimated in the 1-norm
  /// Largest error of a force component at a solved point, relative to the largest; infinite when
  /// the system has no solution.
  double residual = 0;

  /// The residual is what rounding leaves. Otherwise the weights are worth nothing.
  bool accurate() const { return residual <= 1e-8; }
};

/// More solved points than this are refused: the matrix of 5000 and its factors take 0.4 GB, and
/// the time grows with the third power.
inline constexpr std::size_t most_rbf_points = 5000;

/// Solves for the weights. Error when the space has no solved point or more than most_rbf_points.
/// Any thread.
RbfWeights solveRbfWeights(const SpaceTable& space, RbfKernel kernel);

}  // namespace palpate
