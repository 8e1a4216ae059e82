#include "worker/solver/newton.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

/// A state without a residual: the element is inverted (ln det F does not exist) or something
/// overflowed, then det F may be NaN.
Cause causeOfNotFinite(const Residual& residual) {
  return residual.min_det_F <= 0 ? Cause::inverted_element : Cause::not_finite;
}

/// Broyden's updates of an inverse tangent, from the steps that were taken.
class BroydenUpdates {
 public:
  void clear() { steps_.clear(); }
  bool empty() const { return steps_.empty(); }
  void add(Eigen::VectorXd step) { steps_.push_back(std::move(step)); }

  /// Turns the step of the bare inverse into that of the updated one.
  void apply(Eigen::VectorXd& step) const {
    if (steps_.empty()) return;
    for (std::size_t n = 0; n + 1 < steps_.size(); ++n)
      step += steps_[n + 1] * (steps_[n].dot(step) / steps_[n].squaredNorm());
    // At most this much longer: the update may not make the inverse singular.
    constexpr double longest = 5;
    const Eigen::VectorXd& last = steps_.back();
    const double shrink = 1 - last.dot(step) / last.squaredNorm();
    step /= std::max(shrink, 1 / longest);
  }

 private:
  std::vector<Eigen::VectorXd> steps_;
};

/// One solution of the equations; findEquilibrium in steps.
class Newton {
 public:
  Newton(const System& system, TangentSolver& solver, const Eigen::Vector3d& displacement,
         const NewtonOptions& options)
      : system_(system), solver_(solver), displacement_(displacement), options_(options) {}

  NewtonResult solveFrom(State start) {
    PALPATE_ASSERT(start.displacement == displacement_,
                   "Newton moves everything but the tool, whose place the caller chose");
    now_.state = std::move(start);
    system_.assemble(now_.state, now_.residual);
    if (!std::isfinite(now_.residual.norm)) now_.cause = causeOfNotFinite(now_.residual);
    bool stale = true;
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
    return options_.absolute_tolerance * (system_.forceScale() + system_.totalLoad()) +
           options_.relative_tolerance * now_.residual.tool.norm();
  }

  bool renewTangent() {
    if (now_.factorizations == options_.max_factorizations) {
      now_.cause = Cause::iteration_limit;
      return false;
    }
    ++now_.factorizations;
    updates_.clear();
    system_.assemble(now_.state, now_.residual, tangent_);
    now_.factorization = solver_.factorize(tangent_);
    if (!now_.factorization.ok) now_.cause = Cause::factorization_failed;
    return now_.factorization.ok;
  }

  /// False when the tangent has served.
  bool step() {
    ++now_.iterations;
    Eigen::VectorXd step = -now_.residual.free;
    if (!solver_.solve(step)) {
      now_.cause = Cause::factorization_failed;
      return false;
    }
    const bool fresh = updates_.empty();
    updates_.apply(step);
    if (!step.allFinite()) {
      now_.cause = Cause::not_finite;
      return false;
    }
    const double before = now_.residual.norm;
    double factor = 1;
    for (int halvings = 0; !advance(step, factor); ++halvings, factor /= 2) {
      if (!fresh) return false;  // an updated inverse that does not lead downhill
      if (halvings == options_.max_halvings) {
        now_.cause = Cause::line_search_stalled;
        return false;
      }
    }
    const double contraction = now_.residual.norm / before;
    const double iterations_left =
        std::log(tolerance() / now_.residual.norm) / std::log(contraction);
    updates_.add(std::move(step));
    return factor == 1 && (contraction <= options_.slow_contraction ||
                           iterations_left <= options_.iterations_worth_a_tangent);
  }

  bool advance(const Eigen::VectorXd& step, double factor) {
    State next = system_.moved(now_.state, step, factor, displacement_);
    system_.assemble(next, trial_);
    // A NaN compares false: an inadmissible trial is as good as an increase.
    if (!(trial_.norm <= (1 - sufficient_decrease * factor) * now_.residual.norm)) return false;
    now_.state = std::move(next);
    std::swap(now_.residual, trial_);
    return true;
  }

  const System& system_;
  TangentSolver& solver_;
  const Eigen::Vector3d displacement_;
  const NewtonOptions& options_;
  NewtonResult now_;
  Tangent tangent_;
  Residual trial_;
  BroydenUpdates updates_;
};

}  // namespace

NewtonResult findEquilibrium(const System& system, TangentSolver& solver, State start,
                             const Eigen::Vector3d& displacement, const NewtonOptions& options) {
  return Newton(system, solver, displacement, options).solveFrom(std::move(start));
}

}  // namespace palpate
