#pragma once

#include <Eigen/LU>

#include "worker/solver/linear_solver.hpp"
#include "worker/solver/system.hpp"

namespace palpate {

/// Factors of a tangent with its border (Tangent), used to solve for this tangent and for those
/// near it.
///
/// The border of a weighted tool is eliminated: K is factorised alone, and S = border^T K^-1
/// border, 3 x 3, closes the system. Vectors have System::unknowns() + multipliers() rows.
///
/// Factors are in single precision where the pressure is stabilised or absent; the unstabilised
/// pairs, whose pressure block is zero, get double precision. Newton corrections do not need more,
/// and what does (solveWith) is refined to it.
class TangentSolver {
 public:
  /// Analyses the pattern of `system`, which must outlive it. Error when that fails.
  explicit TangentSolver(const System& system);

  /// negative_pivots counts those of the bordered matrix.
  [[nodiscard]] Factorization factorize(const Tangent& tangent);

  /// Overwrites `columns` with the solutions for the tangent last factorised, right to about five
  /// digits in single precision. False when MUMPS reports an error.
  [[nodiscard]] bool solve(Eigen::Ref<Eigen::MatrixXd> columns);

  struct Refined {
    Eigen::MatrixXd solution;
    Eigen::MatrixXd residual;  ///< tangent * solution - right-hand sides
  };
  /// Solves for `tangent` itself with the factors of one near it, by refinement, until each
  /// residual is `tolerance` of its right-hand side, or of mu h (N/m) where that is more. Nothing
  /// when it does not contract by a half each time (then the factors are too far away), or MUMPS
  /// reports an error.
  [[nodiscard]] std::optional<Refined> solveWith(const Tangent& tangent,
                                                 const Eigen::MatrixXd& right_hand_sides,
                                                 double tolerance);

  const LinearSolver& linearSolver() const { return *solver_; }

 private:
  Eigen::MatrixXd multiply(const Tangent& tangent, const Eigen::MatrixXd& x) const;

  const System& system_;
  std::unique_ptr<LinearSolver> solver_;
  // Of the tangent last factorised: its border, K^-1 border, and border^T K^-1 border.
  Eigen::MatrixXd border_, inverse_border_;
  Eigen::PartialPivLU<Eigen::Matrix3d> complement_;
};

}  // namespace palpate
