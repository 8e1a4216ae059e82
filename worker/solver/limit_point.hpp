#pragma once

#include "worker/solver/system.hpp"
#include "worker/solver/tangent_solver.hpp"

namespace palpate {

/// Where the equilibrium path of a tool that moves along a line turns back.
struct LimitPoint {
  double at = 0;                     ///< the farthest point, as a fraction of the way to the target
  std::int32_t negative_pivots = 0;  ///< of the tangent there, beyond the turn
};

/// Follows the equilibria from `start` (displacement p0) towards `target` (metres) by arc length: p
/// = p0 + s (target - p0), with s an unknown (Riks 1979, Crisfield 1981; corrections in the plane
/// normal to the predictor).
///
/// A limit point is returned when s was seen to decrease along the continuous path and the
/// tangent's inertia has changed: beyond it this branch has no equilibrium, so that no step size
/// would have reached the target. Nothing when the target is reached after all, or the path cannot
/// be followed (an element inverts, or max_factorizations are spent).
std::optional<LimitPoint> findLimitPoint(const System& system, TangentSolver& solver,
                                         const State& start, const Eigen::Vector3d& target,
                                         int max_factorizations = 120);

}  // namespace palpate
