#include "worker/transition.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

Failure failureOf(Cause cause, const NewtonResult& newton) {
  Failure failure;
  failure.cause = cause;
  failure.residual = newton.residual.norm;
  failure.element = newton.residual.worst_element;
  failure.element_det_F = newton.residual.min_det_F;
  failure.negative_pivots = newton.factorization.negative_pivots;
  failure.mumps_infog1 = newton.factorization.infog1;
  failure.mumps_infog2 = newton.factorization.infog2;
  return failure;
}

}  // namespace

TransitionSolver::TransitionSolver(const Problem& problem, const ElementKernels& kernels,
                                   TransitionOptions options)
    : problem_(problem),
      options_(options),
      system_(problem, kernels),
      solver_(system_.pattern(), !isInfSupStable(problem.scene.discretization)) {}

std::optional<Start> TransitionSolver::startAtRest(Failure& failure) {
  return linearize(system_.restState(), Eigen::Vector3d::Zero(), failure);
}

std::optional<Start> TransitionSolver::startFrom(const NodalFields& fields,
                                                 const Eigen::Vector3d& displacement, Failure& failure) {
  State state = system_.restState();
  std::copy(fields.displacement.begin(), fields.displacement.end(), state.u.begin());
  for (std::size_t node = 0; node < state.q.size(); ++node)
    state.q[node] = fields.pressure.at(node) / system_.pressureScale();
  // float32 moved the tool by up to half a unit in the last place; put it back where it was.
  for (const std::int32_t node : system_.model().tools[*system_.tool()].nodes)
    for (int i = 0; i < 3; ++i) state.u[3 * node + i] = displacement[i];
  return linearize(std::move(state), displacement, failure);
}

std::optional<Start> TransitionSolver::linearize(State state, const Eigen::Vector3d& displacement,
                                                 Failure& failure) {
  NewtonResult here;
  system_.assemble(state, here.residual, here.tangent);
  here.factorization = solver_.factorize(here.tangent.values);
  Start start{displacement, std::move(state), -here.tangent.tool_coupling};
  if (!here.factorization.ok || !solver_.solve(start.sensitivity)) {
    failure = failureOf(Cause::factorization_failed, here);
    return std::nullopt;
  }
  if (!start.sensitivity.allFinite()) {
    failure = failureOf(Cause::not_finite, here);
    return std::nullopt;
  }
  return start;
}

bool TransitionSolver::accept(NewtonResult& newton, const Eigen::Vector3d& displacement, Reached& reached,
                              Failure& failure) {
  system_.lookAtNodes(newton.state, newton.residual);
  if (problem_.scene.workspace.reject_inverted && !(newton.residual.min_det_F > 0)) {
    failure = failureOf(Cause::inverted_element, newton);
    return false;
  }
  newton.factorization = solver_.factorize(newton.tangent.values);
  ++reached.outcome.cost.factorizations;
  Eigen::MatrixXd sensitivity = -newton.tangent.tool_coupling;
  if (!newton.factorization.ok || !solver_.solve(sensitivity)) {
    failure = failureOf(Cause::factorization_failed, newton);
    return false;
  }
  if (const auto expected = system_.expectedNegativePivots();
      expected && newton.factorization.negative_pivots != *expected) {
    failure = failureOf(Cause::wrong_inertia, newton);
    failure.expected_negative_pivots = *expected;
    return false;
  }
  Equilibrium equilibrium;
  // Subtracted from zero, so that a zero is plain 0 and not -0.
  equilibrium.force = Eigen::Vector3d::Zero() - newton.residual.tool;
  const Eigen::Matrix3d K = newton.tangent.tool + newton.tangent.tool_coupling.transpose() * sensitivity;
  equilibrium.stiffness = Eigen::Matrix3d::Zero() - 0.5 * (K + K.transpose());
  equilibrium.energy = newton.residual.energy;
  equilibrium.min_det_F = newton.residual.min_det_F;
  if (!equilibrium.stiffness.allFinite() || !equilibrium.force.allFinite() ||
      !std::isfinite(equilibrium.energy)) {
    failure = failureOf(Cause::not_finite, newton);
    return false;
  }
  reached.outcome.equilibrium = equilibrium;
  reached.outcome.residual = newton.residual.norm;
  ++reached.outcome.cost.steps;
  reached.end = {displacement, std::move(newton.state), std::move(sensitivity)};
  return true;
}

Reached TransitionSolver::reach(const Start& start, const Eigen::Vector3d& target) {
  const auto began = Clock::now();
  Reached reached;
  Outcome& outcome = reached.outcome;
  const Eigen::Vector3d whole = target - start.displacement;
  const Start* from = &start;
  double at = 0, step = 1;
  while (at < 1) {
    const double next = std::min(1.0, at + step);
    const Eigen::Vector3d displacement =
        next == 1 ? target : Eigen::Vector3d(start.displacement + next * whole);
    const Eigen::VectorXd predictor = from->sensitivity * (displacement - from->displacement);
    NewtonResult newton =
        findEquilibrium(system_, solver_, system_.moved(from->state, predictor, 1, displacement),
                        displacement, options_.newton);
    outcome.cost.newton_iterations += newton.iterations;
    outcome.cost.factorizations += newton.iterations;

    Failure failure;
    bool accepted = false;
    if (newton.cause == Cause::none) {
      accepted = accept(newton, displacement, reached, failure);
    } else {
      failure = failureOf(newton.cause, newton);
    }
    if (accepted) {
      from = &reached.end;
      at = next;
      if (newton.iterations <= options_.easy_iterations) step *= 2;
      failure = failureOf(Cause::step_budget, newton);
    } else {
      step = (next - at) / 2;
    }
    const bool too_small = step < options_.smallest_step;
    const bool too_costly = outcome.cost.factorizations >= options_.max_factorizations;
    if (at < 1 && (too_small || too_costly)) {
      outcome.failure = failure;
      outcome.failure.step_reached = at;
      if (!too_small) outcome.failure.cause = Cause::step_budget;
      break;
    }
  }
  outcome.converged = at >= 1;
  if (outcome.converged) outcome.fields = fieldsOf(reached.end.state);
  outcome.cost.seconds = std::chrono::duration<double>(Clock::now() - began).count();
  return reached;
}

NodalFields TransitionSolver::fieldsOf(const State& state) const {
  NodalFields fields;
  fields.displacement.assign(state.u.begin(), state.u.end());
  fields.pressure.reserve(state.q.size());
  for (const double q : state.q) fields.pressure.push_back(static_cast<float>(q * system_.pressureScale()));
  return fields;
}

}  // namespace palpate
