#include "worker/solver/path.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/number_text.hpp"

namespace palpate {
namespace {

/// Distances of the detour points from the middle of the failed transition, in lengths of the
/// transition.
constexpr std::array<double, 3> detour_widths = {0.5, 1.0, 2.0};
constexpr int detours_around = 6;

std::optional<Reached> reachAround(TransitionSolver& solver, const Start& from,
                                   const Eigen::Vector3d& target, Cost& cost) {
  const Eigen::Vector3d way = target - from.state.displacement;
  const Eigen::Vector3d middle = from.state.displacement + 0.5 * way;
  const Eigen::Vector3d across = way.unitOrthogonal() * way.norm();
  for (const double width : detour_widths)
    for (int n = 0; n < detours_around; ++n) {
      const Eigen::AngleAxisd turned(2 * M_PI * n / detours_around, way.normalized());
      const Reached beside = solver.reach(from, middle + width * (turned * across));
      cost += beside.outcome.cost;
      if (!beside.outcome.converged()) continue;
      Reached reached = solver.reach(*beside.end, target);
      cost += reached.outcome.cost;
      if (reached.outcome.converged()) return reached;
    }
  return std::nullopt;
}

}  // namespace

void refuseMistakenUnit(const Mesh& mesh, const Eigen::Vector3d& displacement) {
  const double diagonal = boundingBox(mesh).diagonal().norm();
  if (displacement.stableNorm() > 3 * diagonal)
    throw badInput(
        "displacement ({}) m is more than 3 times the diagonal of the body's bounding box "
        "({:.4g} m); displacements are in metres",
        vectorText(displacement, 6), diagonal);
}

Reached walk(TransitionSolver& solver, const Start& start, const Eigen::Vector3d& target,
             int transitions, Rescue rescue) {
  PALPATE_ASSERT(transitions >= 1, "a path needs at least one transition");
  Reached path;
  Cost total;
  const Eigen::Vector3d origin = start.state.displacement;
  const Start* at = &start;
  for (int n = 1; n <= transitions; ++n) {
    const Eigen::Vector3d next =
        n == transitions ? target : origin + (target - origin) * n / transitions;
    Reached reached = solver.reach(*at, next);
    total += reached.outcome.cost;
    if (!reached.outcome.converged() && rescue == Rescue::detours) {
      if (auto around = reachAround(solver, *at, next, total)) {
        reached = std::move(*around);
        ++path.detours;
      } else {
        // The search for a limit point costs as much as many transitions, so it comes last.
        solver.explainByLimitPoint(*at, next, reached);
      }
    }
    path.outcome = std::move(reached.outcome);
    if (!path.outcome.converged()) {
      double& step_reached = path.outcome.failure().step_reached;
      step_reached = (n - 1 + step_reached) / transitions;
      break;
    }
    PALPATE_ASSERT(reached.end && reached.end->state.displacement == next,
                   "a converged transition must end at its target");
    path.min_det_F = std::min(path.min_det_F, path.outcome.equilibrium().min_det_F);
    path.end = std::move(reached.end);
    path.held = reached.held;
    at = &*path.end;
  }
  path.outcome.cost = total;
  return path;
}

}  // namespace palpate
