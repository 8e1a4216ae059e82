#include "worker/solver/tangent_solver.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

/// Maximum number of refinements. It suffices for the tolerances of sensitivities even at the
/// slowest accepted contraction. Two to five are usual.
constexpr int max_refinements = 30;
/// The slowest accepted contraction of the residual per refinement. If the contraction is slower, a
/// new factorisation is cheaper than the remaining refinements.
constexpr double slowest_contraction = 0.5;

/// Returns double precision in two cases: the pressure block is zero, so that its pivots may be
/// small, or the body has a nearly rigid part, beside which single precision would lose the soft
/// part.
Precision precisionFor(const BodyModel& body) {
  const PressureSpace pressure = body.discretization.pressure;
  const bool zero_block = pressure == PressureSpace::p1 || pressure == PressureSpace::p2;
  return zero_block || hasNearlyRigidPart(body) ? Precision::double_precision
                                                : Precision::single_precision;
}

}  // namespace

TangentSolver::TangentSolver(const System& system)
    : system_(system),
      solver_(LinearSolver::of(system.pattern(), precisionFor(system.model()),
                               !isInfSupStable(system.model().discretization))) {}

Factorization TangentSolver::factorize(const Tangent& tangent) {
  factorization_ = {};  // if factorize() throws, there are no factors
  factorization_ = solver_->factorize(tangent.values);
  pivots_of_K_ = factorization_.negative_pivots;
  border_ = tangent.border;
  factorization_.ok = factorization_.ok && eliminateBorder();
  return factorization_;
}

bool TangentSolver::useFactorsWith(const Eigen::MatrixXd& border) {
  if (!factorization_.ok) return false;
  border_ = border;
  return factorization_.ok = eliminateBorder();
}

/// Prepares the border for solve() and counts its negative pivots. Returns false if MUMPS reports
/// an error or a number is not finite.
bool TangentSolver::eliminateBorder() {
  factorization_.negative_pivots = pivots_of_K_;
  if (border_.cols() == 0) return true;
  inverse_border_ = border_;
  if (!solver_->solve(inverse_border_)) return false;
  const Eigen::MatrixXd complement = border_.transpose() * inverse_border_;
  if (!complement.allFinite()) return false;
  complement_.compute(complement);
  // By Sylvester's law, the inertia of [K B; B^T 0] is the sum of the inertias of K and of -B^T
  // K^-1 B.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(complement, Eigen::EigenvaluesOnly);
  factorization_.negative_pivots +=
      static_cast<std::int32_t>((eigen.eigenvalues().array() > 0).count());
  return true;
}

bool TangentSolver::solve(Eigen::Ref<Eigen::MatrixXd> columns) {
  const Eigen::Index n = system_.unknowns();
  PALPATE_ASSERT(columns.rows() == n + border_.cols(), "the factors must be of the current tool");
  Eigen::MatrixXd inner = columns.topRows(n);
  if (!solver_->solve(inner)) return false;
  if (border_.cols() > 0) {
    const Eigen::MatrixXd multiplier =
        complement_.solve(border_.transpose() * inner - columns.bottomRows(columns.rows() - n));
    inner -= inverse_border_ * multiplier;
    columns.bottomRows(columns.rows() - n) = multiplier;
  }
  columns.topRows(n) = inner;
  return true;
}

Eigen::MatrixXd TangentSolver::multiply(const Tangent& tangent, const Eigen::MatrixXd& x) const {
  const SparsityPattern& pattern = system_.pattern();
  using FourColumns = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;
  Eigen::MatrixXd y = Eigen::MatrixXd::Zero(x.rows(), x.cols());
  for (Eigen::Index first = 0; first < x.cols(); first += 4) {
    const Eigen::Index count = std::min<Eigen::Index>(4, x.cols() - first);
    FourColumns in = FourColumns::Zero(pattern.n, 4);
    in.leftCols(count) = x.block(0, first, pattern.n, count);
    y.block(0, first, pattern.n, count) = pattern.times(tangent.values, in).leftCols(count);
  }
  if (tangent.border.cols() > 0) {
    const Eigen::Index n = pattern.n;
    y.topRows(n) += tangent.border * x.bottomRows(x.rows() - n);
    y.bottomRows(x.rows() - n) += tangent.border.transpose() * x.topRows(n);
  }
  return y;
}

std::optional<TangentSolver::Refined> TangentSolver::solveWith(
    const Tangent& tangent, const Eigen::MatrixXd& right_hand_sides, double tolerance) {
  Refined refined = {Eigen::MatrixXd::Zero(right_hand_sides.rows(), right_hand_sides.cols()),
                     -right_hand_sides};
  // The right-hand sides of a weighted tool are displacements, but their residuals are forces. So
  // the tolerance is relative to at least this stiffness.
  const double stiffness = system_.forceScale() / system_.meanEdge();
  const Eigen::RowVectorXd size = right_hand_sides.colwise().norm().cwiseMax(stiffness);
  Eigen::MatrixXd correction;
  double before = size.norm();
  for (int refinement = 0; refinement < max_refinements; ++refinement) {
    correction = -refined.residual;
    if (!solve(correction)) return std::nullopt;
    refined.solution += correction;
    refined.residual = multiply(tangent, refined.solution) - right_hand_sides;
    if (!refined.residual.allFinite()) return std::nullopt;
    const double now = refined.residual.norm();
    if ((refined.residual.colwise().norm().array() <= tolerance * size.array()).all())
      return refined;
    if (!(now <= slowest_contraction * before)) return std::nullopt;
    before = now;
  }
  return std::nullopt;
}

}  // namespace palpate
