#pragma once

#include "viewer/fields/cell_field.hpp"
#include "viewer/fields/rbf_sums.hpp"

namespace palpate {

/// Radial basis function phi(r).
enum class RbfKernel { linear, cubic };  ///< phi(r) = r, r^3

/// Weights that interpolate a space's force over its solved points (Peterlik et al. 2010, Eq. 12):
///
///   force(p) = sum over solved points i of  w_i phi(|p - p_i| / spacing)
struct RbfWeights {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
  Rows position;         ///< positions of the solved points, in lattice order; in spacings
  Rows weights;          ///< weights of the solved points, N
  double condition = 0;  ///< condition number of phi(|p_i - p_j|), estimated in the 1-norm
  /// Largest error of a force component at a solved point, relative to the largest force component;
  /// infinite if the system has no solution.
  double residual = 0;

  /// Returns whether the residual is only round-off. Otherwise the weights are useless.
  bool accurate() const { return residual <= 1e-8; }
};

/// Limit of the number of solved points; spaces with more are refused. The matrix of 5000 points
/// and its factors take 0.4 GB, and the time grows with the third power of the number.
inline constexpr std::size_t most_rbf_points = 5000;

/// Solves for the weights. Error if the space has no solved point or more than most_rbf_points. Any
/// thread.
RbfWeights solveRbfWeights(const SpaceTable& space, RbfKernel kernel);

/// The paper's global method: one sum of radial functions over all solved points. One formula holds
/// in the whole ball, without cells. The force therefore has continuous derivatives everywhere;
/// with phi(r) = r, everywhere but at the solved points. The time of a query grows with the number
/// of solved points, and the force is not conservative.
class RbfField : public CellField {
 public:
  /// Solves for the weights. Error if the space has no solved point, too many, or points for which
  /// the system has no accurate solution (such as a single one).
  RbfField(const SpaceTable& space, RbfKernel kernel);

 private:
  void interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                   ForceSample& sample) const noexcept override;

  RbfKernel kernel_;
  std::vector<RbfBlock> blocks_;
};

}  // namespace palpate
