#pragma once

#include <cstdint>

#include "worker/solver/transition.hpp"

namespace palpate {

/// What a walk does about a transition that fails.
enum class Rescue : std::uint8_t {
  none,  ///< it ends there
  /// Tries points beside the path, in 3 widths and 6 directions, and when none helps looks for a
  /// limit point (up to 120 factorisations).
  detours,
};

/// Walks from `start` straight to `target` in `transitions` equal transitions.
///
/// A limit point that stops the straight way is passed by detours on either side, as the lattice
/// passes it by other parents. What is reached is as valid as any configuration (it has the inertia
/// of a stable one), on a branch that a hand which was pushed past the limit point would find
/// itself on.
///
/// `target` in metres, transitions >= 1. The outcome is that of the end, with the cost of all of
/// it; its step_reached is a fraction of the whole path. One thread, that of `solver`.
Reached walk(TransitionSolver& solver, const Start& start, const Eigen::Vector3d& target,
             int transitions, Rescue rescue = Rescue::detours);

}  // namespace palpate
