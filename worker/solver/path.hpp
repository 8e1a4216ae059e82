#pragma once

#include <Eigen/Core>
#include <functional>

#include "worker/solver/transition.hpp"

namespace palpate {

/// How a path went.
struct WalkedPath {
  Outcome
      outcome;  ///< of its end, with the cost of all of it; step_reached is a fraction of the path
  Start end;    ///< when converged
  int detours = 0;       ///< transitions that were made by way of a point beside the path
  double min_det_F = 1;  ///< smallest of its configurations
};

/// Walks from `start` straight to `target` in `transitions` equal transitions. One that fails is
/// tried by way of points beside the path: a limit point that stops the straight way is passed on
/// either side, as the lattice passes it by other parents. What is reached is as valid as any
/// configuration (it has the inertia of a stable one), on a branch that a hand which was pushed
/// past the limit point would find itself on.
///
/// `target` in metres, transitions >= 1. A failure is an answer (WalkedPath::outcome); for a limit
/// point it is looked for as well, which costs up to 120 factorisations. One thread, that of
/// `solver`.
WalkedPath walk(TransitionSolver& solver, const Start& start, const Eigen::Vector3d& target,
                int transitions);

}  // namespace palpate
