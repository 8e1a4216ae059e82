#pragma once

#include <cstdint>

#include "worker/solver/transition.hpp"

namespace palpate {

/// Error (bad input) for a displacement (m) so large that the tool would leave the body. The user
/// has probably used another unit.
void refuseMistakenUnit(const Mesh& mesh, const Eigen::Vector3d& displacement);

/// The reaction of walk() to a failed transition.
enum class Rescue : std::uint8_t {
  none,  ///< ends the path at the failed transition
  /// Tries to reach the end of the transition via a point beside the path, at 3 distances and in 6
  /// directions. If no such detour succeeds, looks for a limit point (up to 120 factorisations).
  detours,
};

/// Moves the tool from `start` straight to `target` (metres) in `transitions` >= 1 equal
/// transitions.
///
/// Detours lead around a limit point that blocks the straight path. A build gets past such a point
/// in the same manner, by solving from another parent. The result is as valid as any configuration:
/// its tangent has the inertia of a stable equilibrium. It lies on the branch that a hand would
/// reach by pushing past the limit point.
///
/// Returns the outcome at the end of the path, with the cost of the whole path.
/// Failure::step_reached is a fraction of the whole path. Runs on the thread of `solver`.
Reached walk(TransitionSolver& solver, const Start& start, const Eigen::Vector3d& target,
             int transitions, Rescue rescue = Rescue::detours);

}  // namespace palpate
