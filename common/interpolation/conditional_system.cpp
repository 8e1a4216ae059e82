#include "common/interpolation/conditional_system.hpp"

#include <Eigen/LU>
#include <limits>

namespace palpate {
namespace {

/// Columns that are independent of earlier ones, by Gram-Schmidt, twice is enough.
std::vector<Eigen::Index> independentColumns(const Eigen::MatrixXd& P) {
  std::vector<Eigen::Index> chosen;
  Eigen::MatrixXd basis(P.rows(), 0);
  for (Eigen::Index column = 0; column < P.cols() && basis.cols() < P.rows(); ++column) {
    Eigen::VectorXd rest = P.col(column);
    const double length = rest.norm();
    for (int pass = 0; pass < 2; ++pass) rest -= basis * (basis.transpose() * rest).eval();
    if (!(rest.norm() > 1e-9 * length)) continue;
    basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
    basis.rightCols<1>() = rest.normalized();
    chosen.push_back(column);
  }
  return chosen;
}

}  // namespace

ConditionalSystem::ConditionalSystem(Eigen::MatrixXd A, const Eigen::MatrixXd& P)
    : A_(std::move(A)), columns_(independentColumns(P)), polynomials_(P.cols()) {
  const auto k = static_cast<Eigen::Index>(columns_.size()), n = A_.rows();
  if (k > 0) {
    Eigen::MatrixXd independent(n, k);
    for (Eigen::Index column = 0; column < k; ++column)
      independent.col(column) = P.col(columns_[static_cast<std::size_t>(column)]);
    P_.compute(independent);
    A_.applyOnTheLeft(P_.householderQ().adjoint());
    A_.applyOnTheRight(P_.householderQ());
  }
  first_ = A_.topLeftCorner(k, k);
  coupling_ = A_.topRightCorner(k, n - k);
  if (n == k) return;
  Eigen::Ref<Eigen::MatrixXd> corner = A_.bottomRightCorner(n - k, n - k);
  factor_.emplace(corner);
  definite_ = factor_->info() == Eigen::Success &&
              factor_->rcond() > std::numeric_limits<double>::epsilon();
}

double ConditionalSystem::condition() const {
  if (!definite_) return std::numeric_limits<double>::infinity();
  return factor_ ? 1 / factor_->rcond() : 1;
}

ConditionalSystem::Solution ConditionalSystem::withTail(const Eigen::MatrixXd& f) const {
  const auto k = static_cast<Eigen::Index>(columns_.size()), n = A_.rows();
  Eigen::MatrixXd rotated = f;
  if (k > 0) rotated.applyOnTheLeft(P_.householderQ().adjoint());
  Solution solution{Eigen::MatrixXd::Zero(n, f.cols()),
                    Eigen::MatrixXd::Zero(polynomials_, f.cols())};
  if (factor_) solution.weights.bottomRows(n - k) = factor_->solve(rotated.bottomRows(n - k));
  if (k == 0) return solution;

  Eigen::MatrixXd rest = rotated.topRows(k) - coupling_ * solution.weights.bottomRows(n - k);
  P_.matrixQR().topRows(k).triangularView<Eigen::Upper>().solveInPlace(rest);
  for (Eigen::Index column = 0; column < k; ++column)
    solution.tail.row(columns_[static_cast<std::size_t>(column)]) = rest.row(column);
  solution.weights.applyOnTheLeft(P_.householderQ());
  return solution;
}

Eigen::MatrixXd ConditionalSystem::withoutTail(const Eigen::MatrixXd& f) const {
  const auto k = static_cast<Eigen::Index>(columns_.size()), n = A_.rows();
  if (k == 0) return withTail(f).weights;
  Eigen::MatrixXd rotated = f;
  rotated.applyOnTheLeft(P_.householderQ().adjoint());
  Eigen::MatrixXd schur = first_;
  if (factor_) {
    const Eigen::MatrixXd eliminated = factor_->solve(coupling_.transpose());
    schur -= coupling_ * eliminated;
    rotated.topRows(k) -= eliminated.transpose() * rotated.bottomRows(n - k);
  }
  rotated.topRows(k) = schur.partialPivLu().solve(rotated.topRows(k)).eval();
  if (factor_)
    rotated.bottomRows(n - k) =
        factor_->solve(rotated.bottomRows(n - k) - coupling_.transpose() * rotated.topRows(k))
            .eval();
  rotated.applyOnTheLeft(P_.householderQ());
  return rotated;
}

}  // namespace palpate
