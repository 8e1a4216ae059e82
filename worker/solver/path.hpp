#pragma once

#include <cstdint>

#include "worker/solver/transition.hpp"

namespace palpate {

/// The response of a walk to a failed transition.
enum class Rescue : std::uint8_t {
  none,  ///< ends the walk there
  /// Tries points beside the path, in 3 widths and 6 directions. If none helps, looks for a limit
  /// point (up to 120 factorisations).
  detours,
};

/// Walks from `start` straight to `target` (metres) in `transitions` >= 1 equal transitions.
///
/// Detours to either side pass a limit point that stops the straight way, as the lattice passes it
/// by other parents. The result is as valid as any configuration (it has the inertia of a stable
/// one). Its branch is the one on which a hand that pushed past the limit point would find itself.
///
/// Returns the outcome at the end of the path, with the cost of the whole path; step_reached is a
/// fraction of the whole path. Runs on the thread of `solver`.
Reached walk(TransitionSolver& solver, const Start& start, const Eigen::Vector3d& target,
             int transitions, Rescue rescue = Rescue::detours);

}  // namespace palpate
