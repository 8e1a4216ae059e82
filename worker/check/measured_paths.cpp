#include "worker/check/measured_paths.hpp"

#include <algorithm>
#include <ctime>
#include <functional>

#include "common/base/assertion.hpp"
#include "worker/solver/transition.hpp"

namespace palpate {
namespace {

/// Returns processor time; wall-clock time would include other programs that keep the cores busy.
double processorSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Returns `direction` if a contact that only pushes can reach it. Otherwise returns its mirror
/// image, which points into the tissue.
Eigen::Vector3d pushed(const Eigen::Vector3d& direction, const PushedPart& part) {
  if (part.contains(1e-6 * direction)) return direction;
  return direction - 2 * std::max(0.0, direction.dot(part.outward)) * part.outward;
}

/// Returns the force half-way between two lattice points, interpolated from their forces and
/// stiffnesses.
Eigen::Vector3d interpolated(const Equilibrium& from, const Equilibrium& to,
                             const Eigen::Vector3d& step) {
  return (from.force + to.force) / 2 + (from.stiffness - to.stiffness) * step / 8;
}

/// Returns PathStep::error of the step between the equilibria `from` and `to`. Solves for the point
/// half-way, from `start`, and compares the force with the interpolated force. Returns 0 if this
/// solve fails, or if its force on a finger exceeds max_force.
double errorHalfWay(TransitionSolver& solver, const Problem& problem, const ActivePatch& active,
                    const Start& start, const Equilibrium& from, const Equilibrium& to,
                    const Eigen::Vector3d& at, const Eigen::Vector3d& step) {
  const Outcome half = solver.reach(start, at - step / 2).outcome;
  if (!half.converged()) return 0;
  const double force = half.equilibrium().force.norm();
  if (active.finger && force > problem.scene.workspace.max_force) return 0;
  const Accuracy& accuracy = problem.scene.accuracy;
  const double allowed = std::max(accuracy.force_error * force, accuracy.force_floor);
  return (interpolated(from, to, step) - half.equilibrium().force).norm() / allowed;
}

/// Solves one path and adds it to `found`. The path runs from rest in this direction until it ends
/// (PathEnd), leaves `part`, or `over` returns true.
void walkOutward(TransitionSolver& solver, const Problem& problem, const ActivePatch& active,
                 const PushedPart& part, const Eigen::Vector3d& direction,
                 const std::function<bool()>& over, MeasuredPaths& found) {
  const Workspace& workspace = problem.scene.workspace;
  const bool adaptive = problem.scene.accuracy.adaptive();
  // The first step includes the time to prepare the start, because a worker also prepares one for
  // every job.
  double step_began = processorSeconds();
  Failure failure;
  std::optional<Start> start = solver.startAtRest(failure);
  if (!start) {
    found.no_rest = describe(failure);
    return;
  }
  PALPATE_ASSERT(workspace.spacing > 0, "the spacing must be positive");
  Path& path = found.paths.emplace_back();
  const auto end = [&](PathEnd how) { path.end = how; };
  Equilibrium before;
  if (adaptive)
    if (const Outcome at_rest = solver.reach(*start, Eigen::Vector3d::Zero()).outcome;
        at_rest.converged())
      before = at_rest.equilibrium();
  for (double at = 0; at < workspace.radius;) {
    if (over()) return end(PathEnd::cut);
    const double from = at;
    // If less than half a spacing would remain after this step, the step goes on to the rim. A
    // separate last step would be shorter than any transition of the lattice.
    at =
        at + 1.5 * workspace.spacing > workspace.radius ? workspace.radius : at + workspace.spacing;
    if (!part.contains(at * direction, workspace.spacing / 2)) return end(PathEnd::cut);
    const Reached reached = start ? solver.reach(*start, at * direction) : Reached{};
    const Outcome& outcome = reached.outcome;
    path.steps.push_back({processorSeconds() - step_began, outcome.converged()});
    ++found.transitions;
    if (!outcome.converged() && path.steps.size() == 1 && found.no_first_step.empty())
      found.no_first_step = describe(outcome.failure());
    if (!outcome.converged()) return end(PathEnd::failed);
    if (path.steps.size() == 1)
      found.stiffness = std::max(found.stiffness, outcome.equilibrium().force.norm() / at);
    if (adaptive)
      path.steps.back().error =
          errorHalfWay(solver, problem, active, *start, before, outcome.equilibrium(),
                       at * direction, (at - from) * direction);
    if (outcome.equilibrium().force.norm() > workspace.max_force) return end(PathEnd::max_force);
    step_began = processorSeconds();
    before = outcome.equilibrium();
    start =
        solver.startFrom(outcome.configuration().fields, reached.end->state.displacement, failure);
  }
}

}  // namespace

MeasuredPaths measurePaths(const Problem& problem, const MeasuringLimits& limits) {
  PALPATE_ASSERT(!problem.active.empty(), "a problem must have an active node");
  const double began = processorSeconds();
  TransitionSolver solver(problem, chooseKernels());
  MeasuredPaths found;
  const auto over = [&] {
    return found.transitions > 0 &&
           (found.transitions >= limits.transitions || processorSeconds() - began > limits.seconds);
  };
  while (!over() && found.no_rest.empty()) {
    const Eigen::Vector3d place = evenlySpread(found.paths.size() + 1);
    const auto space =
        static_cast<std::size_t>(place[2] * static_cast<double>(problem.active.size()));
    solver.chooseTool(space);
    const ActivePatch& active = problem.active[space];
    const PushedPart part = active.finger ? active.finger->reach : PushedPart{};
    walkOutward(solver, problem, active, part, pushed(onSphere(1 - 2 * place[0], place[1]), part),
                over, found);
  }
  PALPATE_ASSERT(!found.paths.empty() || !found.no_rest.empty(),
                 "a body with a rest state must have a measured path");
  found.seconds = processorSeconds() - began;
  return found;
}

}  // namespace palpate
