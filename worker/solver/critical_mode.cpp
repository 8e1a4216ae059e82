#include "worker/solver/critical_mode.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>

#include "common/base/index.hpp"

namespace palpate {
namespace {

constexpr int columns = 4, most_iterations = 60;
constexpr double converged = 1e-6;  ///< relative change of the eigenvalue per iteration
/// A component of at least this fraction of the largest one is treated as equal to it, so that
/// round-off does not decide which of several equal components comes first.
constexpr double as_large = 1 - 1e-6;

/// Returns 1 for the displacement unknowns that no tool holds, 0 for all others.
Eigen::VectorXd freeDisplacements(const System& system) {
  Eigen::VectorXd mask = Eigen::VectorXd::Zero(system.unknowns() + system.multipliers());
  const auto mark = [&](std::int32_t node, double value) {
    for (int i = 0; i < 3; ++i)
      if (const std::int32_t k = system.numbers().at({node, i}); k >= 0) mask[k] = value;
  };
  for (std::int32_t node = 0; at(node) < system.model().mesh.nodes.size(); ++node) mark(node, 1);
  if (system.tool() && system.tool()->weights.empty())
    for (const std::int32_t node : system.tool()->nodes) mark(node, 0);
  return mask;
}

/// Returns columns that span the same space as X and have orthonormal displacement parts. `mask`
/// selects the displacements (freeDisplacements).
Eigen::MatrixXd orthonormal(Eigen::MatrixXd X, const Eigen::VectorXd& mask) {
  for (Eigen::Index k = 0; k < X.cols(); ++k) {
    for (Eigen::Index other = 0; other < k; ++other)
      X.col(k) -= X.col(other).cwiseProduct(mask).dot(X.col(k)) * X.col(other);
    X.col(k) /= X.col(k).cwiseProduct(mask).norm();
  }
  return X;
}

}  // namespace

std::optional<Eigen::VectorXd> criticalMode(const System& system, TangentSolver& solver,
                                            const State& state) {
  Residual residual;
  Tangent tangent;
  system.assemble(state, residual, tangent);
  if (!solver.factorize(tangent).ok) return std::nullopt;
  const Eigen::VectorXd mask = freeDisplacements(system);
  Eigen::MatrixXd X(mask.size(), columns);
  std::mt19937 random(1);
  for (double& value : X.reshaped()) value = 2.0 * random() / 4294967295.0 - 1;
  X = orthonormal(std::move(X), mask);
  double before = 0;
  Eigen::Index worst = -1;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    Eigen::MatrixXd Y = mask.asDiagonal() * X;
    const Eigen::MatrixXd MX = Y;
    if (!solver.solve(Y) || !Y.allFinite()) return std::nullopt;
    const Eigen::MatrixXd A = MX.transpose() * Y;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(0.5 * (A + A.transpose()));
    // These are the inverses of the tangent's eigenvalues, in ascending order. So the last negative
    // one belongs to the tangent's most negative eigenvalue.
    worst = (eigen.eigenvalues().array() < 0).count() - 1;
    X = orthonormal(Y * eigen.eigenvectors(), mask);
    const double inverse = worst < 0 ? 0 : eigen.eigenvalues()[worst];
    if (inverse < 0 && std::abs(inverse - before) < converged * std::abs(inverse)) break;
    before = inverse;
  }
  if (worst < 0) return std::nullopt;
  const Eigen::VectorXd displacement = X.col(worst).cwiseProduct(mask);
  const double largest = displacement.cwiseAbs().maxCoeff();
  const double first = *std::ranges::find_if(
      displacement, [&](double value) { return std::abs(value) >= as_large * largest; });
  return X.col(worst) / first;
}

}  // namespace palpate
