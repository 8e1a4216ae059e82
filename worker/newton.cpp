#include "worker/newton.hpp"

#include <cmath>
#include <utility>

namespace palpate {
namespace {

/// Sufficient decrease of the residual norm, per unit of step (Armijo).
constexpr double sufficient_decrease = 1e-4;

/// A state without a residual: the element is inverted (ln det F does not exist) or something overflowed,
/// then det F may be NaN.
Cause causeOfNotFinite(const Residual& residual) {
  return residual.min_det_F <= 0 ? Cause::inverted_element : Cause::not_finite;
}

}  // namespace

NewtonResult findEquilibrium(const System& system, LinearSolver& solver, State start,
                             const Eigen::Vector3d& displacement, const NewtonOptions& options) {
  NewtonResult now;
  now.state = std::move(start);
  system.assemble(now.state, now.residual, now.tangent);
  if (!std::isfinite(now.residual.norm)) {
    now.cause = causeOfNotFinite(now.residual);
    return now;
  }
  const auto converged = [&] {
    return now.residual.norm <= options.absolute_tolerance * system.forceScale() +
                                    options.relative_tolerance * now.residual.tool.norm();
  };

  Eigen::MatrixXd step;
  Residual trial;
  while (!converged()) {
    if (now.iterations == options.max_iterations) {
      now.cause = Cause::iteration_limit;
      return now;
    }
    ++now.iterations;
    now.factorization = solver.factorize(now.tangent.values);
    step = -now.residual.free;
    if (!now.factorization.ok || !solver.solve(step)) {
      now.cause = Cause::factorization_failed;
      return now;
    }
    if (!step.allFinite()) {
      now.cause = Cause::not_finite;
      return now;
    }
    double factor = 1;
    for (int halvings = 0;; ++halvings, factor /= 2) {
      State next = system.moved(now.state, step, factor, displacement);
      system.assemble(next, trial);
      // A NaN compares false: an inadmissible trial is halved like a bad one.
      if (trial.norm <= (1 - sufficient_decrease * factor) * now.residual.norm) {
        now.state = std::move(next);
        break;
      }
      if (halvings == options.max_halvings) {
        now.cause = Cause::line_search_stalled;
        return now;
      }
    }
    system.assemble(now.state, now.residual, now.tangent);
  }
  return now;
}

}  // namespace palpate
