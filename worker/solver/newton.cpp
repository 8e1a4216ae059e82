#include "worker/solver/newton.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

/// Largest force of the tool to which a tolerance is relative, in force scales. Larger forces mean
/// that elements are crushed; they must not excuse a residual that moves the rest of the body.
constexpr double largest_force = 1e4;

/// Sufficient decrease of the residual norm, per unit of step (Armijo).
constexpr double sufficient_decrease = 1e-4;
/// Limits of the relaxation near the tool: number of iterations, and of halvings per step.
constexpr int most_relaxations = 12, most_halvings = 6;

/// Applies Broyden's updates to `step`, which was solved with the factorised tangent. `taken` holds
/// the steps since that factorisation.
void updateByBroyden(const std::vector<Eigen::VectorXd>& taken, Eigen::VectorXd& step) {
  if (taken.empty()) return;
  for (std::size_t n = 0; n + 1 < taken.size(); ++n)
    step += taken[n + 1] * (taken[n].dot(step) / taken[n].squaredNorm());
  // The last update may lengthen the step at most by this factor. Without a limit it could make the
  // updated inverse singular.
  constexpr double longest = 5;
  const Eigen::VectorXd& last = taken.back();
  const double shrink = 1 - last.dot(step) / last.squaredNorm();
  step /= std::max(shrink, 1 / longest);
}

/// One run of findEquilibrium.
class Newton {
 public:
  Newton(const System& system, TangentSolver& solver, const Eigen::Vector3d& displacement,
         const NewtonOptions& options)
      : system_(system), solver_(solver), displacement_(displacement), options_(options) {}

  NewtonResult solveFrom(State start) {
    PALPATE_ASSERT(start.displacement == displacement_,
                   "the start must have the displacement of the tool");
    now_.state = std::move(start);
    system_.assemble(now_.state, now_.residual);
    if (!std::isfinite(now_.residual.norm)) now_.cause = causeOfNotFinite(now_.residual);
    bool stale = !options_.begin_with_old_factors;
    if (!stale) now_.factorization = solver_.factorization();
    while (now_.cause == Cause::none && now_.residual.norm > tolerance()) {
      if (now_.iterations == options_.max_iterations) {
        now_.cause = Cause::iteration_limit;
      } else if (!stale || renewTangent()) {
        stale = !step();
      }
    }
    return std::move(now_);
  }

 private:
  double tolerance() const {
    const double scale = system_.forceScale();
    return options_.absolute_tolerance * (scale + system_.totalLoad()) +
           options_.relative_tolerance * std::min(now_.residual.tool.norm(), largest_force * scale);
  }

  bool renewTangent() {
    if (now_.factorizations == options_.max_factorizations) {
      now_.cause = Cause::iteration_limit;
      return false;
    }
    ++now_.factorizations;
    taken_.clear();
    system_.assemble(now_.state, now_.residual, tangent_);
    now_.factorization = solver_.factorize(tangent_);
    if (!now_.factorization.ok) now_.cause = Cause::factorization_failed;
    return now_.factorization.ok;
  }

  /// Takes one step. Returns false if the next step needs a new tangent, or if Newton failed
  /// (now_.cause).
  bool step() {
    ++now_.iterations;
    Eigen::VectorXd step = -now_.residual.free;
    if (!solver_.solve(step)) {
      now_.cause = Cause::factorization_failed;
      return false;
    }
    const bool fresh = taken_.empty() && now_.factorizations > 0;
    updateByBroyden(taken_, step);
    if (!step.allFinite()) {
      now_.cause = Cause::not_finite;
      return false;
    }
    const double before = now_.residual.norm;
    double factor = 1;
    for (int halvings = 0; !advance(step, factor); ++halvings, factor /= 2) {
      if (!fresh) return false;  // the updated inverse gives no descent
      if (halvings == options_.max_halvings) {
        now_.cause = Cause::line_search_stalled;
        return false;
      }
    }
    const double contraction = now_.residual.norm / before;
    const double iterations_left =
        std::log(tolerance() / now_.residual.norm) / std::log(contraction);
    taken_.push_back(std::move(step));
    return !options_.renew_always && factor == 1 &&
           (contraction <= options_.slow_contraction ||
            iterations_left <= options_.iterations_worth_a_tangent);
  }

  bool advance(const Eigen::VectorXd& step, double factor) {
    State next = system_.moved(now_.state, step, factor, displacement_);
    system_.assemble(next, trial_);
    // The comparison with a NaN is false, so an inadmissible trial is rejected like an increase.
    if (!(trial_.norm <= (1 - sufficient_decrease * factor) * now_.residual.norm) &&
        !(options_.affine_descent && isNearer(step, factor)))
      return false;
    now_.state = std::move(next);
    std::swap(now_.residual, trial_);
    return true;
  }

  /// Returns whether the correction that the same tangent gives at the trial state is smaller than
  /// `step` (NewtonOptions::affine_descent).
  bool isNearer(const Eigen::VectorXd& step, double factor) {
    if (!std::isfinite(trial_.norm)) return false;
    Eigen::VectorXd left = -trial_.free;
    return solver_.solve(left) && system_.displacementsOf(left).norm() <=
                                      (1 - factor / 4) * system_.displacementsOf(step).norm();
  }

  const System& system_;
  TangentSolver& solver_;
  const Eigen::Vector3d displacement_;
  const NewtonOptions& options_;
  NewtonResult now_;
  Tangent tangent_;
  Residual trial_;
  std::vector<Eigen::VectorXd> taken_;  ///< steps since the last factorisation
};

}  // namespace

Cause causeOfNotFinite(const Residual& residual) {
  return residual.min_det_F <= 0 ? Cause::inverted_element : Cause::not_finite;
}

NewtonResult findEquilibrium(const System& system, TangentSolver& solver, State start,
                             const Eigen::Vector3d& displacement, const NewtonOptions& options) {
  return Newton(system, solver, displacement, options).solveFrom(std::move(start));
}

bool relaxNearTool(const System& system, const Neighborhood& neighborhood, State& state,
                   double tolerance) {
  State now = state;
  Eigen::VectorXd residual, trial_residual, whole_step = Eigen::VectorXd::Zero(system.unknowns());
  Eigen::MatrixXd tangent, trial_tangent;
  system.assemble(now, neighborhood, residual, tangent);
  for (int iteration = 0; residual.norm() > tolerance; ++iteration) {
    if (iteration == most_relaxations) return false;
    whole_step(neighborhood.unknowns) = -tangent.partialPivLu().solve(residual);
    bool descended = false;
    double factor = 1;
    for (int halvings = 0; !descended && halvings <= most_halvings; ++halvings, factor /= 2) {
      State next = system.moved(now, whole_step, factor, state.displacement);
      system.assemble(next, neighborhood, trial_residual, trial_tangent);
      descended = trial_residual.norm() <= (1 - sufficient_decrease * factor) * residual.norm();
      if (descended) now = std::move(next);
    }
    if (!descended) return false;
    residual.swap(trial_residual);
    tangent.swap(trial_tangent);
  }
  if (!residual.allFinite()) return false;
  state = std::move(now);
  return true;
}

}  // namespace palpate
