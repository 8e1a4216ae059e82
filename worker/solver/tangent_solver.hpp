#pragma once

#include <Eigen/LU>

#include "worker/solver/linear_solver.hpp"
#include "worker/solver/system.hpp"

namespace palpate {

/// Factorises tangents with their border (Tangent). Solves linear systems with the last factorised
/// tangent, or with a tangent near it.
///
/// The border of weighted tools is eliminated: K is factorised alone, and the complement border^T
/// K^-1 border, 3 x 3 or 6 x 6, closes the system. Vectors have System::unknowns() + multipliers()
/// rows.
///
/// Factors are in single precision if the pressure is stabilised or absent. Unstabilised pairs of
/// spaces make the pressure block zero and get double precision, as do bodies with a nearly rigid
/// part. Single precision suffices for Newton corrections; solveWith() refines its solutions to a
/// tolerance.
class TangentSolver {
 public:
  /// Analyses the pattern of `system`, which must outlive this object. Error if the analysis fails.
  explicit TangentSolver(const System& system);

  /// Factorises `tangent`. Factorization::negative_pivots is the count for the bordered matrix.
  [[nodiscard]] Factorization factorize(const Tangent& tangent);

  /// Replaces the border and keeps the factors of K. A sliding finger changes mainly the border, so
  /// the old factors of K remain good enough. Returns false if there are no factors, or if MUMPS
  /// reports an error.
  [[nodiscard]] bool useFactorsWith(const Eigen::MatrixXd& border);
  /// The report on the factors, with negative_pivots for the present border.
  const Factorization& factorization() const { return factorization_; }

  /// Replaces the right-hand sides in `columns` by solutions for the last factorised tangent.
  /// In single precision, about five digits are right. Returns false if MUMPS reports an error.
  [[nodiscard]] bool solve(Eigen::Ref<Eigen::MatrixXd> columns);

  struct Refined {
    Eigen::MatrixXd solution;
    Eigen::MatrixXd residual;  ///< tangent * solution - right-hand sides
  };
  /// Solves linear systems with `tangent` by iterative refinement. Uses the factors of the last
  /// factorised tangent, which must be near `tangent`. Stops when the residual norm of each column
  /// is at most `tolerance` times the norm of its right-hand side, or times mu h (N/m) if that is
  /// more. Returns nullopt if a refinement does not halve the residual (the factors are too far
  /// away), or if MUMPS reports an error.
  [[nodiscard]] std::optional<Refined> solveWith(const Tangent& tangent,
                                                 const Eigen::MatrixXd& right_hand_sides,
                                                 double tolerance);

  const LinearSolver& linearSolver() const { return *solver_; }

 private:
  Eigen::MatrixXd multiply(const Tangent& tangent, const Eigen::MatrixXd& x) const;

  const System& system_;
  bool eliminateBorder();

  std::unique_ptr<LinearSolver> solver_;
  Factorization factorization_;
  std::int32_t pivots_of_K_ = 0;  ///< number of negative pivots of K
  // The border of the last factorised tangent, K^-1 border, and border^T K^-1 border.
  Eigen::MatrixXd border_, inverse_border_;
  Eigen::PartialPivLU<Eigen::MatrixXd> complement_;
};

}  // namespace palpate
